#include "haptics/around/holding_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sparsha::haptics {
namespace {

constexpr double kLeastDepth = 0.5;  // cells: of a hand, that it is held
constexpr double kAskCells = 2.0;    // between places on the way to the proxy: faces are known 2.5 cells away
constexpr int kMostPlaces = 8;
constexpr double kMeetCells = 2.5;  // between faces that meet at a place
constexpr double kAbove = 1.5;      // cells: above a hollow corner its wall was measured
constexpr double kOpposite = -0.9;  // cosine of 154 degrees: the faces of a wall, which do not meet
constexpr double kUnder = 0.1;      // cells: under the proxy's face, where the way of a hand inside ends
constexpr double kMeets = 0.2;      // cells: beyond another face, of what no longer continues its own
constexpr int kFootSteps = 2;       // of a foot on a bent face

/// A face as seen from a place: where its foot on it lies.
struct Foot {
  std::uint32_t sheet = kNoSheet;
  std::uint8_t cell = kNoCell;
  double gap_m = 0.0;  ///< along the normal, positive outside
  Eigen::Vector3d place_m, normal;
};

std::optional<Foot> foot_on(const ObjectSurface& object, std::uint32_t number,
                            const Eigen::Vector3d& place_m) noexcept {
  const SheetSurface& sheet = object.sheets[number];
  SheetView view = view_of(sheet, place_m);
  if (view.cell == kNoCell) return {};
  double gap_m = view.gap_m;
  for (int k = 0; k < kFootSteps; ++k) {
    view = view_of(sheet, place_m - gap_m * view.normal);
    if (view.cell == kNoCell) return {};
    gap_m = (place_m - sheet.to_object(view.local)).dot(view.normal);
  }
  return Foot{number, view.cell, gap_m, sheet.to_object(view.local), view.normal};
}

/// The measured cell of a sheet that is nearest to a place on its rim.
std::optional<Eigen::Vector3d> border_near(const SheetSurface& sheet, const Eigen::Vector3d& place_m,
                                           double spacing_m) noexcept {
  constexpr int kReach = kRimCells + 1;
  const Eigen::Vector3d local = sheet.to_local(place_m);
  const int i = static_cast<int>(std::floor(local.x() / spacing_m));
  const int j = static_cast<int>(std::floor(local.y() / spacing_m));
  int nearest = std::numeric_limits<int>::max(), a_best = 0, b_best = 0;
  for (int b = -kReach; b <= kReach; ++b)
    for (int a = -kReach; a <= kReach; ++a) {
      if (a * a + b * b >= nearest || sheet.cell(i + a, j + b) < kLookCell) continue;
      nearest = a * a + b * b;
      a_best = a, b_best = b;
    }
  if (nearest == std::numeric_limits<int>::max()) return {};
  const Eigen::Vector3d middle{(i + a_best + 0.5) * spacing_m, (j + b_best + 0.5) * spacing_m, 0.0};
  return sheet.to_object(view_of(sheet, sheet.to_object(middle)).local);
}

/// What continues a sheet is part of the object up to where another face meets it: is a foot on a rim on the same side
/// of all other faces as the measured cell nearest to it?
bool is_part(const ObjectSurface& object, const Foot& rim) noexcept {
  const double tolerance_m = kMeets * object.spacing_m;
  const auto border_m = border_near(object.sheets[rim.sheet], rim.place_m, object.spacing_m);
  if (!border_m) return false;
  for (const Passing& passing : object.blocks.sheets_at(rim.place_m)) {
    if (passing.sheet == rim.sheet) continue;
    const auto here = foot_on(object, passing.sheet, rim.place_m);
    if (!here || std::abs(here->gap_m) <= tolerance_m) continue;
    const double border_gap_m = (*border_m - here->place_m).dot(here->normal);
    if (std::copysign(1.0, here->gap_m) * border_gap_m <= tolerance_m) return false;
  }
  return true;
}

/// The feet of a place on the faces about it, what continues faces only as far as it is part of the object.
class Feet {
 public:
  Feet(const ObjectSurface& object, const Eigen::Vector3d& place_m) noexcept {
    for (const Passing& passing : object.blocks.sheets_at(place_m)) {
      const auto foot = foot_on(object, passing.sheet, place_m);
      if (!foot || count_ == feet_.size() || (foot->cell < kLookCell && !is_part(object, *foot))) continue;
      if (nearest_ == nullptr || std::abs(foot->gap_m) < std::abs(nearest_->gap_m)) nearest_ = &feet_[count_];
      feet_[count_++] = *foot;
    }
  }
  [[nodiscard]] const Foot* nearest() const noexcept { return nearest_; }
  /// The nearest that the place lies behind and that pushes it this way; nullptr without any.
  [[nodiscard]] const Foot* over(const Eigen::Vector3d& push_m, const Eigen::Vector3d& normal) const noexcept {
    const Foot* best = nullptr;
    for (std::size_t k = 0; k < count_; ++k) {
      const Foot& foot = feet_[k];
      if (foot.gap_m >= 0.0 || foot.normal.dot(push_m) <= 0.0 || foot.normal.dot(normal) < -kSameNormal) continue;
      if (best == nullptr || foot.gap_m > best->gap_m) best = &foot;
    }
    return best;
  }

 private:
  std::array<Foot, 12> feet_;
  std::size_t count_ = 0;
  const Foot* nearest_ = nullptr;
};

/// Is another face that meets one with this normal measured near a place, or so far above or below it, where `use` says
/// so of its foot?
template <std::size_t N, typename Use>
bool meets_face(const ObjectSurface& object, const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal,
                const std::array<double, N>& above, const Use& use) noexcept {
  const double h = object.spacing_m;
  for (const double cells : above) {
    const Eigen::Vector3d near_m = place_m + cells * h * normal;
    for (const Passing& passing : object.blocks.sheets_at(near_m)) {
      const auto foot = foot_on(object, passing.sheet, near_m);
      if (!foot || foot->cell < kLookCell || std::abs(foot->gap_m) > kMeetCells * h) continue;
      const double cosine = foot->normal.dot(normal);
      if (cosine < kSameNormal && cosine > kOpposite && use(*foot)) return true;
    }
  }
  return false;
}

/// Is a place of a face with this normal in a hollow corner: was another face measured near it on the outer side?
bool is_in_hollow(const ObjectSurface& object, const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal) noexcept {
  return meets_face(object, place_m, normal, std::array{0.5 * kAbove, kAbove, 2.0 * kAbove},
                    [&](const Foot& foot) { return (foot.place_m - place_m).dot(normal) > 0.5 * object.spacing_m; });
}

/// Does a face with this normal meet another one near a place, so that it does not end there as at a hole of the scan?
bool is_at_edge(const ObjectSurface& object, const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal) noexcept {
  return meets_face(object, place_m, normal, std::array{0.0, -kAbove, kAbove}, [](const Foot&) { return true; });
}

/// Is a proxy behind the surface, on what continues a wall under its floor?
bool is_within(const ObjectSurface& object, const Eigen::Vector3d& proxy_m) noexcept {
  constexpr double kWithin = 0.8;  // of what is enclosed: a hollow corner of two faces is by 0.75
  return object.enclosure->at(proxy_m) > kWithin;
}

/// From the hand on towards the proxy, places are asked until faces are known about one.
std::optional<Crossing> face_over(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                  const Eigen::Vector3d& proxy_m, const Eigen::Vector3d& normal) noexcept {
  const Eigen::Vector3d way_m = proxy_m - hand_m;
  const double length_m = way_m.norm();
  for (int k = 0; k < kMostPlaces; ++k) {
    const double gone_m = k * kAskCells * object.spacing_m;
    if (gone_m > length_m) return {};
    const Eigen::Vector3d place_m = k == 0 ? hand_m : Eigen::Vector3d(hand_m + gone_m / length_m * way_m);
    const Feet feet(object, place_m);
    if (feet.nearest() == nullptr) continue;
    if (feet.nearest()->gap_m > -(k == 0 ? kLeastDepth : 0.0) * object.spacing_m) return {};
    const Foot* over = feet.over(way_m, normal);
    if (over == nullptr) return {};
    return Crossing{over->sheet, 1.0, object.sheets[over->sheet].to_local(over->place_m)};
  }
  return {};
}

/// Where faces meet in an edge or a corner: is a hand still under them, since no face is met from outside on the way
/// from it to the proxy?
bool is_under_faces(const ObjectSurface& object, const Eigen::Vector3d& hand_m, const Eigen::Vector3d& proxy_m,
                    const Eigen::Vector3d& normal, CellShape shape) noexcept {
  const double h = object.spacing_m;
  // In front of a face, however far from it, the hand is not.
  const Feet feet(object, hand_m);
  if (feet.nearest() != nullptr && feet.nearest()->gap_m > 0.0) return false;
  const Eigen::Vector3d under_m = proxy_m - kUnder * h * normal;
  const Flight flight = fly(object, hand_m, under_m, false, shape);
  if (!flight.crossing || flight.crossing->share >= 1.0) return flight.share >= 1.0;
  const SheetSurface& sheet = object.sheets[flight.crossing->sheet];
  const Eigen::Vector3d place_m = sheet.to_object(flight.crossing->local_m);
  const SheetView view = view_of(sheet, place_m);
  return view.cell < kLookCell && !is_part(object, {flight.crossing->sheet, view.cell, 0.0, place_m, view.normal});
}

}  // namespace

std::optional<Crossing> holding_face(const ObjectSurface& object, const Eigen::Vector3d& hand_m, const LastHold& last,
                                     CellShape shape) noexcept {
  if (last.view.cell == kNoCell) {
    if (last.ended || !object.enclosure->holds(hand_m)) return {};
    return face_towards(object, hand_m, last.place_m);
  }
  const Eigen::Vector3d proxy_m = object.sheets[last.sheet].to_object(last.view.local);
  const bool ended = last.ended && !is_at_edge(object, proxy_m, last.view.normal) && !is_within(object, proxy_m);
  const bool enclosed = !ended && object.enclosure->holds(hand_m);
  if (!enclosed && !is_in_hollow(object, proxy_m, last.view.normal)) return {};
  if (auto face = face_over(object, hand_m, proxy_m, last.view.normal)) return face;
  if (!enclosed && !is_under_faces(object, hand_m, proxy_m, last.view.normal, shape)) return {};
  return Crossing{last.sheet, 1.0, last.view.local};
}

std::optional<Crossing> face_towards(const ObjectSurface& object, const Eigen::Vector3d& hand_m,
                                     const Eigen::Vector3d& outside_m) noexcept {
  const Eigen::Vector3d way_m = outside_m - hand_m;
  if (!(way_m.norm() > 0.0)) return {};
  return face_over(object, hand_m, outside_m, way_m.normalized());
}

}  // namespace sparsha::haptics
