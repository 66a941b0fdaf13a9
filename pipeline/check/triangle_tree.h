// The triangles of a mesh as the cross-check asks for them: the nearest one to a place, and what the viewer sees of
// them over one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/threads/thread_pool.h"

namespace sparsha::pipeline {

/// A hierarchy of boxes, halved at the median of the longest side, so that triangles of any size are found quickly.
/// Immutable; queries are thread-safe. Takes 12 bytes per vertex and about 20 per triangle; neither it nor what it
/// answers depends on the number of threads.
class TriangleTree {
 public:
  /// `xyz` holds x y z of one vertex after the other, metres; z points to the viewer. Faces name existing vertices.
  TriangleTree(std::vector<float> xyz, const std::vector<std::array<std::uint32_t, 3>>& faces, ThreadPool& pool);

  /// Distance to the nearest point of a triangle, exact but for rounding; positive when that point is nearer to the
  /// viewer. Infinite without triangles.
  [[nodiscard]] double signed_distance(double x, double y, double z) const;

  /// z of the highest point over (x, y); nothing where no triangle is. Triangles that the viewer sees edge-on do not
  /// count.
  [[nodiscard]] std::optional<double> highest(double x, double y) const;

 private:
  struct Box {
    std::array<float, 3> low, high;
  };
  /// A leaf holds `count` triangles from number `first` on; other nodes have two children, nodes `first` and
  /// `first` + 1.
  struct Node {
    Box box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  using Triangle = std::array<std::array<double, 3>, 3>;
  class Builder;

  [[nodiscard]] Triangle triangle(std::uint32_t number) const;

  std::vector<float> xyz_;
  std::vector<std::array<std::uint32_t, 3>> faces_;  ///< in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace sparsha::pipeline
