// Mean distance of every point of a cloud to its nearest neighbours, exact and much faster than one search at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/threads/context.h"
#include "base/threads/thread_pool.h"

namespace sparsha::pipeline {

/// A kd-tree with 16 points a leaf. All points of a leaf are searched together: what is near one of them is near all,
/// so the tree is descended once for all of them, and distances are taken sixteen at a time. Distances are float32 and
/// computed as FLANN does, (dx^2 + dy^2) + dz^2, so that the neighbours are the same.
class NeighbourTree {
 public:
  /// `xyz1` holds `count` points of four floats; finite. It is not kept. Throws Cancelled.
  NeighbourTree(const float* xyz1, std::size_t count, const Context& context);

  /// mean[i] = mean distance of point i to its `neighbours` nearest other points; the number is cut to what there is.
  /// Does not depend on the number of threads. Throws Cancelled.
  [[nodiscard]] std::vector<float> mean_distances(int neighbours, const Context& context) const;

  static constexpr std::size_t kLeaf = 16;

 private:
  struct Point {
    float x, y, z;
    std::uint32_t index;
  };
  struct Box {
    std::array<float, 3> low, high;
  };
  struct Node {
    Box box;
    std::uint32_t left = 0;  ///< 0: a leaf
    std::uint32_t right = 0;
    std::uint32_t first = 0;  ///< of a leaf: its number; while building: its points' range
    std::uint32_t count = 0;
  };
  /// Slots beyond the count are at infinity, where nothing is near.
  struct Leaf {
    std::array<float, kLeaf> x, y, z;
    std::array<std::uint32_t, kLeaf> index;
    std::uint32_t node = 0;
    std::uint32_t count = 0;
  };
  struct Search;

  static std::size_t split(std::span<Point> points, const Box& box);
  static Box bounds(std::span<const Point> points);
  static void build(std::vector<Node>& nodes, std::span<Point> points, std::size_t least, const Progress& progress);
  void make_leaves(std::span<const Point> points);
  void search_leaf(const Leaf& leaf, Search& search) const;

  std::size_t size_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
};

}  // namespace sparsha::pipeline
