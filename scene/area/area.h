// Where a part or a sound lies: a box, a polygon, the pixels of a label, or a box in space. The one answer to "is this
// place inside" and "how far inside", for speech, sound, touch, pictures and the guide.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "scene/area/label_area.h"
#include "scene/area/polygon.h"
#include "scene/area/region_frame.h"

namespace sparsha::scene {

/// `box_m`: xmin ymin xmax ymax, borders included.
[[nodiscard]] inline bool in_box(const std::array<double, 4>& box_m, double x_m, double y_m) {
  return x_m >= box_m[0] && y_m >= box_m[1] && x_m <= box_m[2] && y_m <= box_m[3];
}

/// A box in x, y and z of the frame of the scans, as whole objects have them.
struct SolidBox {
  std::array<double, 6> box_m{};  ///< xmin ymin zmin xmax ymax zmax, scan frame, borders included
  RegionFrame scan_from_region = RegionFrame::Identity();
  double enlarged = 1.0;  ///< metres of the scans' frame per metre of the regions'

  [[nodiscard]] static SolidBox of(const std::array<double, 6>& box_m, const RegionFrame& scan_from_region);
  /// How far inside, negative outside: the least of the ways to its six sides; metres of the regions' frame.
  [[nodiscard]] double inside_m(const Eigen::Vector3d& place_m) const noexcept;
  /// The box round it in the regions' frame: xmin ymin xmax ymax.
  [[nodiscard]] std::array<double, 4> outline_m() const noexcept;
  /// Its middle, regions' frame.
  [[nodiscard]] Eigen::Vector3d middle_m() const noexcept;
  bool operator==(const SolidBox& other) const = default;
};

/// Places in metres, in the frame that the area is written in. A value that is cheap to copy; any thread. What is
/// noexcept allocates nothing and serves the servo thread.
class Area {
 public:
  using Box = std::array<double, 4>;
  /// Closed: the last point is the first once more.
  using Loop = std::vector<Eigen::Vector2d>;

  /// Nowhere.
  Area() = default;
  Area(double xmin_m, double ymin_m, double xmax_m, double ymax_m) : shape_(Box{xmin_m, ymin_m, xmax_m, ymax_m}) {}
  explicit Area(const Box& box_m) : shape_(box_m) {}
  explicit Area(std::shared_ptr<const Polygon> polygon) : shape_(std::move(polygon)) {}
  explicit Area(std::shared_ptr<const LabelArea> label) : shape_(std::move(label)) {}
  explicit Area(const SolidBox& solid) : shape_(solid) {}

  /// Of a box itself, null of the others.
  [[nodiscard]] const Box* box() const noexcept { return std::get_if<Box>(&shape_); }
  [[nodiscard]] std::shared_ptr<const Polygon> polygon() const;
  [[nodiscard]] std::shared_ptr<const LabelArea> label() const;
  /// Null of all others.
  [[nodiscard]] const SolidBox* solid() const noexcept { return std::get_if<SolidBox>(&shape_); }

  /// In space: of a solid box whether it is inside, of all others whatever the place's z is.
  [[nodiscard]] bool holds(const Eigen::Vector3d& place_m) const noexcept;
  [[nodiscard]] double share_inside(const Eigen::Vector3d& place_m, double width_m) const noexcept;
  [[nodiscard]] bool decides(const Eigen::Vector3d& place_m, double width_m) const noexcept;

  // Questions about x and y alone take a solid box as the rectangle round its outline.
  [[nodiscard]] bool holds(double x_m, double y_m) const noexcept;
  /// 1 inside, 0 outside, a smooth step over `width_m` across the border: of a box as share_inside() of
  /// scene/area/region_frame.h, of a polygon by the distance to its border, of a label by LabelArea::inside_m().
  /// Outside the corner of a box it is that of the nearer of two sides, outside a polygon's corner that of the corner.
  [[nodiscard]] double share_inside(double x_m, double y_m, double width_m) const noexcept;
  /// Whether a place counts as inside for what cannot fade: more than half of share_inside() of boxes, else holds().
  [[nodiscard]] bool decides(double x_m, double y_m, double width_m) const noexcept;
  /// Distance to the nearest place inside; 0 inside. Of a label outside its picture at least that.
  [[nodiscard]] double distance_m(double x_m, double y_m) const noexcept;
  /// How far inside a place is, negative outside: of a box the least of the ways to its four sides.
  [[nodiscard]] double inside_m(double x_m, double y_m) const noexcept;

  /// xmin ymin xmax ymax; empty when no place is inside.
  [[nodiscard]] std::optional<Box> bounds_m() const;
  /// A place inside to go to: the middle of the bounds where that is at least half as deep inside as the deepest place,
  /// else the deepest place, of a label in several pieces that of the largest. Of a box its middle. Empty when no place
  /// is inside.
  [[nodiscard]] std::optional<Eigen::Vector2d> middle_m() const;
  /// Of a polygon that crosses itself, what its direction of turning leaves of it.
  [[nodiscard]] double area_m2() const;
  /// One of a box or a polygon; of a label one for each piece and each hole, longest first.
  [[nodiscard]] std::vector<Loop> borders_m() const;

  /// The same box, or the same polygon or label in memory.
  bool operator==(const Area& other) const = default;

 private:
  using PolygonPointer = std::shared_ptr<const Polygon>;
  using LabelPointer = std::shared_ptr<const LabelArea>;
  std::variant<std::monostate, Box, PolygonPointer, LabelPointer, SolidBox> shape_;
};

}  // namespace sparsha::scene
