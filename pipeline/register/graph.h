// Which scans are linked to which: the strongest tree from the first scan.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/register/relaxation.h"

namespace sparsha::pipeline {

/// An edge with how much it can be relied on.
struct WeighedEdge {
  Edge edge;
  double weight = 0.0;
};

/// The heaviest spanning tree from scan 0 (Prim): indices of edges in the order in which they reach new scans, and the
/// scans they do not reach.
struct Tree {
  std::vector<std::size_t> edges;
  std::vector<std::size_t> unreached;
};
[[nodiscard]] Tree heaviest_tree(std::size_t scans, const std::vector<WeighedEdge>& edges);

}  // namespace sparsha::pipeline
