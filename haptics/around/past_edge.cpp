#include "haptics/around/past_edge.h"

#include <algorithm>

#include "haptics/around/flight.h"

namespace sparsha::haptics {
namespace {

constexpr double kBesideEdge = 0.5;   // cells: of a hand before an edge's other face, at least
constexpr double kRoundEdge = 1.0;    // cells: before both faces, of a way round an edge
constexpr double kAboveCorner = 1.5;  // cells: above a hollow corner its wall was measured, and so far below not
constexpr double kLeastTilt = 0.1;    // sine of the angle between the two faces of an edge
constexpr int kMostRounds = 4;        // ways round an edge that are tried

bool is_free(const ObjectSurface& object, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, bool leaving,
             CellShape shape) noexcept {
  const Flight flight = fly(object, from_m, to_m, leaving, shape);
  return !flight.crossing && flight.share >= 1.0;
}

}  // namespace

bool is_hand_past_edge(const ObjectSurface& object, std::uint32_t own, const Eigen::Vector3d& proxy_m,
                       const Eigen::Vector3d& hand_m, CellShape shape) noexcept {
  const double h = object.spacing_m;
  const SheetView at = view_of(object.sheets[own], proxy_m);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  if (at.cell != kNoCell) normal = at.normal;
  const Eigen::Vector3d off_m = proxy_m + kRoundEdge * h * normal;
  // What a sheet is continued by is no witness against faces that were measured about the hand.
  const bool within = is_within_edge(object, hand_m);
  bool rises = false;
  int rounds = 0;
  for (const double share : {0.0, 0.5, 1.0}) {
    const Eigen::Vector3d near_m = proxy_m + share * (hand_m - proxy_m);
    for (const Passing& passing : object.blocks.sheets_at(near_m)) {
      const SheetView view = view_of(object.sheets[passing.sheet], near_m);
      // The other face of a thin wall is no way round.
      if (view.cell == kNoCell || view.normal.dot(normal) <= -kSameNormal) continue;
      if (within && view.cell < kLookCell) continue;
      if (is_wall_of_corner(object, passing.sheet, view, proxy_m, normal)) continue;
      const Eigen::Vector3d foot_m = object.sheets[passing.sheet].to_object(view.local);
      if ((hand_m - foot_m).dot(view.normal) < kBesideEdge * h) continue;
      if ((proxy_m - foot_m).dot(view.normal) > kEdgeGap * h) continue;
      rises = rises || is_free(object, proxy_m, off_m, true, shape);
      if (!rises || ++rounds > kMostRounds) return false;
      const double behind_m = kRoundEdge * h - (off_m - foot_m).dot(view.normal);
      const Eigen::Vector3d before_m = off_m + std::max(0.0, behind_m) * view.normal;
      if (is_free(object, off_m, before_m, false, shape) && is_free(object, before_m, hand_m, false, shape))
        return !object.enclosure->holds(hand_m);
    }
  }
  return false;
}

bool is_wall_of_corner(const ObjectSurface& object, std::uint32_t face, const SheetView& view,
                       const Eigen::Vector3d& proxy_m, const Eigen::Vector3d& normal) noexcept {
  const Eigen::Vector3d up = normal - normal.dot(view.normal) * view.normal;
  if (up.norm() <= kLeastTilt) return false;
  const Eigen::Vector3d step_m = kAboveCorner * object.spacing_m * up.normalized();
  const SheetSurface& sheet = object.sheets[face];
  return view_of(sheet, proxy_m + step_m).cell >= kLookCell && view_of(sheet, proxy_m - step_m).cell < kLookCell;
}

}  // namespace sparsha::haptics
