// A depth image with cells of about two point distances.
#include "pipeline/register/line_of_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr double kCell = 2.0;          // point distances
constexpr double kNearestDepth = 0.2;  // of the middle's: what lies nearer is seen at too wide an angle

}  // namespace

LineOfSight::LineOfSight(const StationSurface& surface, const Eigen::Vector3d& place, const Eigen::Vector3d& middle)
    : place_(place), distance_m_((middle - place).norm()), cell_m_(kCell * surface.spacing_m()) {
  if (!(distance_m_ > 0.0) || !(cell_m_ > 0.0)) return;
  const Eigen::Vector3d depth = (middle - place) / distance_m_;
  axes_.row(2) = depth;
  axes_.row(0) = depth.unitOrthogonal();
  axes_.row(1) = depth.cross(Eigen::Vector3d(axes_.row(0)));
  for (const StationSurface::Element& element : surface.elements()) {
    Pixel pixel;
    if (!project(element.point, pixel)) {
      nearest_m_.clear();
      return;
    }
    const auto [cell, fresh] = nearest_m_.try_emplace(key(pixel.x, pixel.y), pixel.depth_m);
    if (!fresh) cell->second = std::min(cell->second, pixel.depth_m);
  }
}

bool LineOfSight::project(const Eigen::Vector3d& point, Pixel& pixel) const {
  const Eigen::Vector3d p = axes_ * (point - place_);
  if (!(p.z() > kNearestDepth * distance_m_)) return false;
  const double per_cell = distance_m_ / (p.z() * cell_m_);
  constexpr double kFar = 1e9;
  if (std::fabs(p.x() * per_cell) > kFar || std::fabs(p.y() * per_cell) > kFar) return false;
  pixel = {static_cast<std::int64_t>(std::floor(p.x() * per_cell)),
           static_cast<std::int64_t>(std::floor(p.y() * per_cell)), p.z()};
  return true;
}

std::uint64_t LineOfSight::key(std::int64_t x, std::int64_t y) {
  return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffU);
}

double LineOfSight::in_the_way(const StationSurface& other, const Eigen::Isometry3d& other_to_this,
                               double clearance_m) const {
  std::size_t tried = 0;
  std::size_t blocking = 0;
  if (nearest_m_.empty()) return 0.0;
  for (const StationSurface::Element& element : other.elements()) {
    if (element.normal.isZero(0.0)) continue;
    ++tried;
    Pixel pixel;
    if (!project(other_to_this * element.point, pixel) || !nearest_m_.contains(key(pixel.x, pixel.y))) continue;
    double nearest_m = std::numeric_limits<double>::max();
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        const auto cell = nearest_m_.find(key(pixel.x + dx, pixel.y + dy));
        if (cell != nearest_m_.end()) nearest_m = std::min(nearest_m, cell->second);
      }
    }
    if (pixel.depth_m < nearest_m - clearance_m) ++blocking;
  }
  return tried == 0 ? 0.0 : static_cast<double>(blocking) / static_cast<double>(tried);
}

}  // namespace sparsha::pipeline
