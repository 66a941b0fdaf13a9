#include "haptics/servo/object_hand.h"

#include <algorithm>
#include <cmath>

#include "scene/solid/stretch.h"

namespace sparsha::haptics {
double depth_behind_m(const ObjectSurface& object, const Eigen::Vector3d& place_m, const Eigen::Vector3d& towards,
                      CellShape shape) noexcept {
  constexpr int kMostFlights = 64;
  constexpr double kMarginCells = 2.0;
  Eigen::AlignedBox3d box_m = object.box_m;
  if (box_m.isEmpty() || !place_m.allFinite()) return 0.0;
  box_m.min().array() -= kMarginCells * object.spacing_m;
  box_m.max().array() += kMarginCells * object.spacing_m;
  const scene::Stretch stretch = scene::stretch_in(box_m, place_m, towards);
  if (!(stretch.last > stretch.first)) return 0.0;
  Eigen::Vector3d from_m = place_m + stretch.last * towards;
  const Eigen::Vector3d end_m = place_m + stretch.first * towards;
  for (int k = 0; k < kMostFlights; ++k) {
    const Flight flight = fly(object, from_m, end_m, false, shape);
    if (flight.crossing) {
      const Eigen::Vector3d met_m = object.sheets[flight.crossing->sheet].to_object(flight.crossing->local_m);
      return std::max(0.0, (met_m - place_m).dot(towards));
    }
    if (flight.share >= 1.0) return 0.0;
    from_m += flight.share * (end_m - from_m);
  }
  return 0.0;
}

}  // namespace sparsha::haptics
