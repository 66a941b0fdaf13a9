// The grid's nodes as a triangle mesh, two triangles a cell, under a tree of axis-aligned boxes (median split, four
// triangles a leaf): first hit of a segment, and closest point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"

namespace sparsha::bench {

/// Of a triangle, by the regions of its corners, edges and inside.
[[nodiscard]] Eigen::Vector3d closest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                            const Eigen::Vector3d& b, const Eigen::Vector3d& c);

class TriangleTree {
 public:
  explicit TriangleTree(const haptics::MongeSurface& surface);

  struct Hit {
    double share = 2.0;  ///< of the segment; above 1: none
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    std::int32_t triangle = -1;
  };
  /// The first triangle that the segment enters from its upper side.
  [[nodiscard]] Hit first_hit(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;
  /// Is this point over the inside of the triangle, at most `height_m` above it?
  [[nodiscard]] bool is_over(std::int32_t triangle, const Eigen::Vector3d& point, double height_m) const;
  /// The mesh's point nearest to `point`; none when it is not nearer than `bound`.
  [[nodiscard]] std::optional<Eigen::Vector3d> nearest(const Eigen::Vector3d& point, double bound) const;
  /// A triangle's point nearest to a query, and the triangle's unit normal.
  struct Near {
    Eigen::Vector3d point;
    Eigen::Vector3d normal;
  };
  /// One for each triangle that reaches into the ball of `reach` about `point`; `found` keeps its memory.
  void near(const Eigen::Vector3d& point, double reach, std::vector<Near>& found) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Box {
    float low[3];
    float high[3];
    std::int32_t first =
        0;  ///< leaf: first triangle; inner: index of the second child, the first one follows its parent
    std::int32_t count = 0;  ///< leaf: triangles; inner: 0
  };
  struct Triangle {
    std::int32_t node[3];
  };
  [[nodiscard]] Eigen::Vector3d vertex(const Triangle& triangle, int k) const {
    return vertices_[static_cast<std::size_t>(triangle.node[k])].cast<double>();
  }
  [[nodiscard]] static double squared_distance(const Box& box, const Eigen::Vector3d& point);
  void split(std::size_t begin, std::size_t end);
  void meet(std::int32_t index, const Eigen::Vector3d& from, const Eigen::Vector3d& way, Hit& best) const;

  double spacing_m_;
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<Box> boxes_;
};

}  // namespace sparsha::bench
