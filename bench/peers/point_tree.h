// A kd-tree over points (median split on the longest side, leaves of up to eight), with the normals of the points by
// principal components of their neighbours. Queries visit all points in a cube.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"

namespace sparsha::bench {

class PointTree {
 public:
  /// The grid's nodes, as raw points.
  explicit PointTree(const haptics::MongeSurface& surface);

  /// visit(index) for every point whose coordinates all lie within `half` of `centre`; a few outside are visited too.
  template <class Visit>
  void visit_cube(const Eigen::Vector3d& centre, double half, const Visit& visit) const {
    std::int32_t stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(stack[--depth])];
      if (node.axis < 0) {
        for (std::int32_t k = node.first; k < node.last; ++k) visit(static_cast<std::size_t>(k));
        continue;
      }
      if (centre[node.axis] - half <= node.split) stack[depth++] = node.first;
      if (centre[node.axis] + half >= node.split) stack[depth++] = node.last;
    }
  }
  [[nodiscard]] Eigen::Vector3d point(std::size_t index) const { return points_[index].cast<double>(); }
  [[nodiscard]] Eigen::Vector3d normal(std::size_t index) const { return normals_[index].cast<double>(); }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }
  /// Unit normals towards +z, from the points within `radius_m`.
  void make_normals(double radius_m);
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Node {
    float split = 0.0F;
    std::int32_t axis = -1;  ///< -1: leaf
    std::int32_t first = 0;  ///< leaf: first point; else the lower child
    std::int32_t last = 0;   ///< leaf: past its last point; else the upper child
  };
  std::int32_t split(std::size_t begin, std::size_t end);

  double spacing_m_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<Node> nodes_;
};

}  // namespace sparsha::bench
