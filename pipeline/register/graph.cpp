// Prim's algorithm; ties go to the edge that comes first, so that the result is one.
#include "pipeline/register/graph.h"

namespace sparsha::pipeline {

Tree heaviest_tree(std::size_t scans, const std::vector<WeighedEdge>& edges) {
  Tree tree;
  std::vector<bool> reached(scans, false);
  if (scans > 0) reached[0] = true;
  while (true) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (reached[edges[k].edge.a] == reached[edges[k].edge.b]) continue;
      if (!best || edges[k].weight > edges[*best].weight) best = k;
    }
    if (!best) break;
    tree.edges.push_back(*best);
    reached[edges[*best].edge.a] = reached[edges[*best].edge.b] = true;
  }
  for (std::size_t s = 0; s < scans; ++s)
    if (!reached[s]) tree.unreached.push_back(s);
  return tree;
}

}  // namespace sparsha::pipeline
