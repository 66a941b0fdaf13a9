// Prim's algorithm; ties go to the edge that comes first, so that the result is one.
#include "pipeline/register/graph.h"

#include <algorithm>
#include <utility>

namespace sparsha::pipeline {
namespace {

// The edges of a tree between the ends of another edge, in any order.
std::vector<std::size_t> path_between(const Tree& tree, std::size_t scans, const std::vector<WeighedEdge>& edges,
                                      const Edge& ends) {
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> next(scans);  // edge and the scan beyond it
  for (const std::size_t k : tree.edges) {
    next[edges[k].edge.a].emplace_back(k, edges[k].edge.b);
    next[edges[k].edge.b].emplace_back(k, edges[k].edge.a);
  }
  std::vector<std::pair<std::size_t, std::size_t>> came(scans, {edges.size(), scans});  // by which edge, from where
  std::vector<std::size_t> open{ends.a};
  while (!open.empty() && came[ends.b].first == edges.size()) {
    const std::size_t here = open.back();
    open.pop_back();
    for (const auto& [edge, beyond] : next[here]) {
      if (beyond == ends.a || came[beyond].first != edges.size()) continue;
      came[beyond] = {edge, here};
      open.push_back(beyond);
    }
  }
  std::vector<std::size_t> path;
  for (std::size_t at = ends.b; at != ends.a && came[at].first != edges.size(); at = came[at].second)
    path.push_back(came[at].first);
  return path;
}

}  // namespace

std::vector<Eigen::Isometry3d> poses_along(const Tree& tree, std::size_t scans, const std::vector<WeighedEdge>& edges,
                                           const std::vector<Eigen::Isometry3d>& b_to_a,
                                           const Eigen::Isometry3d& first) {
  std::vector<Eigen::Isometry3d> poses(scans, Eigen::Isometry3d::Identity());
  std::vector<bool> placed(scans, false);
  poses[0] = first;
  placed[0] = true;
  for (const std::size_t k : tree.edges) {
    const auto& [a, b, any_sign] = edges[k].edge;
    if (placed[a]) {
      poses[b] = poses[a] * b_to_a[k];
    } else {
      poses[a] = poses[b] * b_to_a[k].inverse();
    }
    placed[a] = placed[b] = true;
  }
  return poses;
}

Tree agreed_tree(std::size_t scans, const std::vector<WeighedEdge>& edges, const std::vector<Eigen::Isometry3d>& b_to_a,
                 const Agrees& agrees) {
  Tree tree = heaviest_tree(scans, edges);
  if (!tree.unreached.empty()) return tree;
  std::vector<std::size_t> against;
  const auto weight_of = [&](const Tree& candidate, std::vector<std::size_t>* contradicting) {
    const std::vector<Eigen::Isometry3d> poses =
        poses_along(candidate, scans, edges, b_to_a, Eigen::Isometry3d::Identity());
    double sum = 0.0;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (agrees(k, poses[edges[k].edge.a].inverse() * poses[edges[k].edge.b])) {
        sum += edges[k].weight;
      } else if (contradicting != nullptr) {
        contradicting->push_back(k);
      }
    }
    return sum;
  };
  // The same edges in the order in which they reach scans from the first one.
  const auto with = [&](std::size_t gone, std::size_t come) {
    std::vector<WeighedEdge> of_tree;
    std::vector<std::size_t> names;
    for (const std::size_t k : tree.edges) {
      names.push_back(k == gone ? come : k);
      of_tree.push_back(edges[names.back()]);
    }
    Tree changed = heaviest_tree(scans, of_tree);
    for (std::size_t& k : changed.edges) k = names[k];
    return changed;
  };
  double weight = weight_of(tree, &against);
  while (!against.empty()) {
    std::optional<Tree> better;
    for (const std::size_t come : against) {
      for (const std::size_t gone : path_between(tree, scans, edges, edges[come].edge)) {
        Tree changed = with(gone, come);
        const double sum = weight_of(changed, nullptr);
        if (sum <= weight * (1.0 + 1e-9)) continue;
        weight = sum;
        better = std::move(changed);
      }
    }
    if (!better) return tree;
    tree = std::move(*better);
    against.clear();
    (void)weight_of(tree, &against);
  }
  return tree;
}

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
