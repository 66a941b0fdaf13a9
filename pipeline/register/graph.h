// Which scans are linked to which: the strongest tree from the first scan.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

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

/// Poses along a tree from that of scan 0; `b_to_a` of each edge. Identity for scans that the tree does not reach.
[[nodiscard]] std::vector<Eigen::Isometry3d> poses_along(const Tree& tree, std::size_t scans,
                                                         const std::vector<WeighedEdge>& edges,
                                                         const std::vector<Eigen::Isometry3d>& b_to_a,
                                                         const Eigen::Isometry3d& first);

/// Whether an edge agrees with a pose of b in the frame of a that others tell.
using Agrees = std::function<bool(std::size_t edge, const Eigen::Isometry3d& b_to_a)>;

/// The heaviest tree, changed edge by edge as long as the weight of the edges that agree with its poses grows: an edge
/// that is wrong in itself (one place aside in what repeats) closes no loop.
[[nodiscard]] Tree agreed_tree(std::size_t scans, const std::vector<WeighedEdge>& edges,
                               const std::vector<Eigen::Isometry3d>& b_to_a, const Agrees& agrees);

}  // namespace sparsha::pipeline
