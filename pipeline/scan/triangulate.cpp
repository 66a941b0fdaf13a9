#include "pipeline/scan/triangulate.h"

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kMostCorners = 64;

struct Corner {
  std::uint32_t index;
  double u, v;  ///< in the polygon's plane, counter-clockwise
};

/// Twice the signed area of a, b, c.
double turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

bool contains(const Corner& a, const Corner& b, const Corner& c, const Corner& p) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

/// Corners along the two axes across which the polygon's area vector (Newell 1972) is largest.
std::vector<Corner> flatten(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> points) {
  const Eigen::Vector3d& base = points[corners[0]];
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = points[corners[i]] - base;
    const Eigen::Vector3d b = points[corners[(i + 1) % corners.size()]] - base;
    area += a.cross(b);
  }
  int axis = 0;
  area.cwiseAbs().maxCoeff(&axis);
  const int first = (axis + 1) % 3;
  const int second = (axis + 2) % 3;
  const double sign = area[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<Corner> flat;
  flat.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Eigen::Vector3d p = points[corner] - base;
    flat.push_back({corner, sign * p[first], p[second]});
  }
  return flat;
}

bool is_convex(const std::vector<Corner>& flat) {
  const std::size_t n = flat.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0.0) return false;
  }
  return true;
}

bool is_ear(const std::vector<Corner>& left, std::size_t i) {
  const std::size_t n = left.size();
  const Corner& a = left[(i + n - 1) % n];
  const Corner& b = left[i];
  const Corner& c = left[(i + 1) % n];
  if (turn(a, b, c) <= 0.0) return false;
  for (const Corner& p : left) {
    if (p.index != a.index && p.index != b.index && p.index != c.index && contains(a, b, c, p)) return false;
  }
  return true;
}

}  // namespace

void triangulate_as_fan(std::span<const std::uint32_t> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

void triangulate(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> points,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (corners.size() < 3) return;
  if (corners.size() == 3 || corners.size() > kMostCorners) {
    triangulate_as_fan(corners, triangles);
    return;
  }
  std::vector<Corner> left = flatten(corners, points);
  if (is_convex(left)) {
    triangulate_as_fan(corners, triangles);
    return;
  }
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t ear = 0;
    while (ear < n && !is_ear(left, ear)) ++ear;
    if (ear == n) ear = 0;  // crosses itself: no ear is right, any keeps the outline closed
    triangles.push_back({left[(ear + n - 1) % n].index, left[ear].index, left[(ear + 1) % n].index});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({left[0].index, left[1].index, left[2].index});
}

}  // namespace sparsha::pipeline
