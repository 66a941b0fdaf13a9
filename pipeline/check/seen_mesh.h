// A mesh as one view shows it: what the cross-check compares the surface with instead of points.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/check/triangle_tree.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// A place that the cross-check may sample, metres relative to the lattice's origin, and the hash that decides.
struct SampledPlace {
  std::uint64_t key;
  std::array<float, 3> place;
};

class SeenMesh {
 public:
  /// `cloud` must have faces. `projection` and its grid have to outlive this. Throws Error{input} where a face names a
  /// point that is not there.
  SeenMesh(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection, ThreadPool& pool);

  /// One flag per point: whether it is a corner of a face. Corners are no measurements of their own.
  [[nodiscard]] const std::vector<std::uint8_t>& corners() const { return corners_; }
  [[nodiscard]] const TriangleTree& triangles() const { return triangles_; }

  /// Places spread evenly over the picture: in the square about each node one, chosen at random by the node's number,
  /// on the highest triangle there. Of these all whose key is at most `threshold`, by ascending nodes. Where the
  /// surface is that of points in front of the mesh, the view does not show it.
  [[nodiscard]] std::vector<SampledPlace> places(std::uint64_t threshold, const Context& context) const;

 private:
  [[nodiscard]] bool is_behind_points(double column, double row, double z_m) const;

  const scene::DepthGrid& grid_;
  double gap_m_;
  std::vector<std::uint8_t> corners_;
  bool only_mesh_;
  TriangleTree triangles_;
};

}  // namespace sparsha::pipeline
