#include "bench/peers/point_tree.h"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace sparsha::bench {

using Eigen::Vector3d;
using Eigen::Vector3f;

PointTree::PointTree(const haptics::MongeSurface& surface) : spacing_m_(surface.lattice.spacing_m) {
  points_.reserve(surface.lattice.count());
  for (int j = 0; j < surface.lattice.ny; ++j)
    for (int i = 0; i < surface.lattice.nx; ++i)
      points_.push_back(
          Vector3d(i * spacing_m_, j * spacing_m_, surface.height_m[surface.lattice.index(i, j)]).cast<float>());
  split(0, points_.size());
}

std::int32_t PointTree::split(std::size_t begin, std::size_t end) {
  constexpr std::size_t kLeaf = 8;
  const std::size_t here = nodes_.size();
  nodes_.emplace_back();
  if (end - begin <= kLeaf) {
    nodes_[here].first = static_cast<std::int32_t>(begin);
    nodes_[here].last = static_cast<std::int32_t>(end);
    return static_cast<std::int32_t>(here);
  }
  Vector3f low = points_[begin];
  Vector3f high = low;
  for (std::size_t k = begin; k < end; ++k) {
    low = low.cwiseMin(points_[k]);
    high = high.cwiseMax(points_[k]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto first = points_.begin();
  std::nth_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(middle),
                   first + static_cast<std::ptrdiff_t>(end),
                   [axis](const Vector3f& a, const Vector3f& b) { return a[axis] < b[axis]; });
  nodes_[here].axis = axis;
  nodes_[here].split = points_[middle][axis];
  const std::int32_t lower = split(begin, middle);
  const std::int32_t upper = split(middle, end);
  nodes_[here].first = lower;
  nodes_[here].last = upper;
  return static_cast<std::int32_t>(here);
}

void PointTree::make_normals(double radius_m) {
  normals_.resize(points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Vector3d centre = point(k);
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    visit_cube(centre, radius_m, [&](std::size_t other) {
      const Vector3d d = point(other) - centre;
      if (d.squaredNorm() > radius_m * radius_m) return;
      sum += d;
      squares += d * d.transpose();
      ++count;
    });
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares / (radius_m * radius_m) - sum * sum.transpose() / (count * radius_m * radius_m));
    const Vector3d normal = solver.eigenvectors().col(0);
    normals_[k] = (normal.z() < 0.0 ? Vector3d(-normal) : normal).cast<float>();
  }
}

std::size_t PointTree::bytes() const {
  return (points_.size() + normals_.size()) * sizeof(Vector3f) + nodes_.size() * sizeof(Node);
}

}  // namespace sparsha::bench
