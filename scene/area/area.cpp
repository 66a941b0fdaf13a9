#include "scene/area/area.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "scene/area/region_frame.h"

namespace sparsha::scene {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

bool near_box(const Area::Box& box, double x_m, double y_m, double reach_m) noexcept {
  return x_m >= box[0] - reach_m && y_m >= box[1] - reach_m && x_m <= box[2] + reach_m && y_m <= box[3] + reach_m;
}

double signed_m(const Polygon& polygon, double x_m, double y_m, double farthest_m) noexcept {
  const double way_m = polygon.to_border_m(x_m, y_m, farthest_m);
  return polygon.holds(x_m, y_m) ? way_m : -way_m;
}

}  // namespace

SolidBox SolidBox::of(const std::array<double, 6>& box_m, const RegionFrame& scan_from_region) {
  return {box_m, scan_from_region, std::cbrt(std::abs(scan_from_region.leftCols<3>().determinant()))};
}

double SolidBox::inside_m(const Eigen::Vector3d& place_m) const noexcept {
  const Eigen::Vector3d at = scan_from_region * place_m.homogeneous();
  double inside = kFar;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double value = at[static_cast<Eigen::Index>(axis)];
    inside = std::min({inside, value - box_m[axis], box_m[axis + 3] - value});
  }
  return inside / enlarged;
}

std::array<double, 4> SolidBox::outline_m() const noexcept {
  const Eigen::Matrix3d region_from_scan = scan_from_region.leftCols<3>().inverse();
  std::array<double, 4> outline{kFar, kFar, -kFar, -kFar};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d scan(box_m[corner & 1U ? 3 : 0], box_m[corner & 2U ? 4 : 1], box_m[corner & 4U ? 5 : 2]);
    const Eigen::Vector3d at = region_from_scan * (scan - scan_from_region.col(3));
    outline = {std::min(outline[0], at.x()), std::min(outline[1], at.y()), std::max(outline[2], at.x()),
               std::max(outline[3], at.y())};
  }
  return outline;
}

Eigen::Vector3d SolidBox::middle_m() const noexcept {
  const Eigen::Vector3d middle(box_m[0] + box_m[3], box_m[1] + box_m[4], box_m[2] + box_m[5]);
  return scan_from_region.leftCols<3>().inverse() * (0.5 * middle - scan_from_region.col(3));
}

bool Area::holds(const Eigen::Vector3d& place_m) const noexcept {
  return solid() != nullptr ? solid()->inside_m(place_m) >= 0.0 : holds(place_m.x(), place_m.y());
}

double Area::share_inside(const Eigen::Vector3d& place_m, double width_m) const noexcept {
  if (solid() == nullptr) return share_inside(place_m.x(), place_m.y(), width_m);
  if (!(width_m > 0.0)) return holds(place_m) ? 1.0 : 0.0;
  return smooth_step(0.5 + solid()->inside_m(place_m) / width_m);
}

bool Area::decides(const Eigen::Vector3d& place_m, double width_m) const noexcept {
  return solid() != nullptr ? share_inside(place_m, width_m) >= 0.5 : decides(place_m.x(), place_m.y(), width_m);
}

std::shared_ptr<const Polygon> Area::polygon() const {
  const auto* polygon = std::get_if<PolygonPointer>(&shape_);
  return polygon != nullptr ? *polygon : nullptr;
}

std::shared_ptr<const LabelArea> Area::label() const {
  const auto* label = std::get_if<LabelPointer>(&shape_);
  return label != nullptr ? *label : nullptr;
}

bool Area::holds(double x_m, double y_m) const noexcept {
  if (const Box* own = box()) return in_box(*own, x_m, y_m);
  if (const auto* polygon = std::get_if<PolygonPointer>(&shape_)) return (*polygon)->holds(x_m, y_m);
  if (const auto* label = std::get_if<LabelPointer>(&shape_)) return (*label)->holds(x_m, y_m);
  if (solid() != nullptr) return in_box(solid()->outline_m(), x_m, y_m);
  return false;
}

double Area::share_inside(double x_m, double y_m, double width_m) const noexcept {
  if (solid() != nullptr) return scene::share_inside(solid()->outline_m(), x_m, y_m, width_m);
  if (const Box* own = box()) return scene::share_inside(*own, x_m, y_m, width_m);
  if (!(width_m > 0.0)) return holds(x_m, y_m) ? 1.0 : 0.0;
  const double reach_m = 0.5 * width_m;
  if (const auto* polygon = std::get_if<PolygonPointer>(&shape_)) {
    if (!near_box((*polygon)->bounds_m(), x_m, y_m, reach_m)) return 0.0;
    return smooth_step(0.5 + signed_m(**polygon, x_m, y_m, reach_m) / width_m);
  }
  if (const auto* label = std::get_if<LabelPointer>(&shape_)) {
    if ((*label)->empty() || !near_box((*label)->bounds_m(), x_m, y_m, reach_m)) return 0.0;
    return smooth_step(0.5 + (*label)->inside_m(x_m, y_m) / width_m);
  }
  return 0.0;
}

bool Area::decides(double x_m, double y_m, double width_m) const noexcept {
  return box() != nullptr || solid() != nullptr ? share_inside(x_m, y_m, width_m) >= 0.5 : holds(x_m, y_m);
}

double Area::inside_m(double x_m, double y_m) const noexcept {
  if (solid() != nullptr) return Area(solid()->outline_m()).inside_m(x_m, y_m);
  if (const Box* own = box()) return std::min({x_m - (*own)[0], y_m - (*own)[1], (*own)[2] - x_m, (*own)[3] - y_m});
  if (const auto* polygon = std::get_if<PolygonPointer>(&shape_)) return signed_m(**polygon, x_m, y_m, kFar);
  if (const auto* label = std::get_if<LabelPointer>(&shape_)) return (*label)->inside_m(x_m, y_m);
  return -kFar;
}

double Area::distance_m(double x_m, double y_m) const noexcept {
  if (solid() != nullptr) return Area(solid()->outline_m()).distance_m(x_m, y_m);
  if (const Box* own = box())
    return std::hypot(std::max({(*own)[0] - x_m, 0.0, x_m - (*own)[2]}),
                      std::max({(*own)[1] - y_m, 0.0, y_m - (*own)[3]}));
  return holds(x_m, y_m) ? 0.0 : std::max(0.0, -inside_m(x_m, y_m));
}

std::optional<Area::Box> Area::bounds_m() const {
  if (solid() != nullptr) return solid()->outline_m();
  if (const Box* own = box()) return *own;
  if (const auto* polygon = std::get_if<PolygonPointer>(&shape_); polygon != nullptr && (*polygon)->deepest_m())
    return (*polygon)->bounds_m();
  if (const auto* label = std::get_if<LabelPointer>(&shape_); label != nullptr && !(*label)->empty())
    return (*label)->bounds_m();
  return std::nullopt;
}

std::optional<Eigen::Vector2d> Area::middle_m() const {
  const std::optional<Box> bounds = bounds_m();
  if (!bounds) return std::nullopt;
  if (solid() != nullptr) return Eigen::Vector2d(solid()->middle_m().head<2>());
  const Eigen::Vector2d middle(0.5 * ((*bounds)[0] + (*bounds)[2]), 0.5 * ((*bounds)[1] + (*bounds)[3]));
  if (box() != nullptr) return middle;
  std::optional<std::array<double, 2>> deepest;
  if (const auto* polygon = std::get_if<PolygonPointer>(&shape_)) deepest = (*polygon)->deepest_m();
  if (const auto* label = std::get_if<LabelPointer>(&shape_)) deepest = (*label)->deepest_m();
  if (!deepest) return middle;
  constexpr double kDeepEnough = 0.5;
  const double depth_m = inside_m((*deepest)[0], (*deepest)[1]);
  if (holds(middle.x(), middle.y()) && inside_m(middle.x(), middle.y()) >= kDeepEnough * depth_m) return middle;
  return Eigen::Vector2d((*deepest)[0], (*deepest)[1]);
}

double Area::area_m2() const {
  if (solid() != nullptr) return Area(solid()->outline_m()).area_m2();
  if (const Box* own = box()) return ((*own)[2] - (*own)[0]) * ((*own)[3] - (*own)[1]);
  if (const auto* polygon = std::get_if<PolygonPointer>(&shape_))
    return std::abs(signed_area_m2((*polygon)->corners_m()));
  if (const auto* label = std::get_if<LabelPointer>(&shape_)) return (*label)->area_m2();
  return 0.0;
}

std::vector<Area::Loop> Area::borders_m() const {
  if (solid() != nullptr) return Area(solid()->outline_m()).borders_m();
  Loop loop;
  if (const Box* own = box()) {
    const Box& b = *own;
    loop = {{b[0], b[1]}, {b[2], b[1]}, {b[2], b[3]}, {b[0], b[3]}};
  } else if (const auto* polygon = std::get_if<PolygonPointer>(&shape_)) {
    for (const auto& corner : (*polygon)->corners_m()) {
      const Eigen::Vector2d place(corner[0], corner[1]);
      if (loop.empty() || loop.back() != place) loop.push_back(place);
    }
    while (loop.size() > 1 && loop.back() == loop.front()) loop.pop_back();
  } else if (const auto* label = std::get_if<LabelPointer>(&shape_)) {
    return (*label)->borders_m();
  }
  if (loop.size() < 3) return {};
  loop.push_back(loop.front());
  return {loop};
}

}  // namespace sparsha::scene
