#include "haptics/servo/object_hand.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::haptics {
namespace {

/// Where the ray is in the box, in its own lengths; `last` below `first` where it is not.
struct Stretch {
  double first = 0.0;
  double last = std::numeric_limits<double>::infinity();
};

Stretch stretch_in(const Eigen::AlignedBox3d& box_m, const Eigen::Vector3d& from_m,
                   const Eigen::Vector3d& way) noexcept {
  Stretch stretch;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box_m.min()[axis] - from_m[axis];
    const double high = box_m.max()[axis] - from_m[axis];
    if (way[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return {1.0, 0.0};
      continue;
    }
    const double a = low / way[axis];
    const double b = high / way[axis];
    stretch.first = std::max(stretch.first, std::min(a, b));
    stretch.last = std::min(stretch.last, std::max(a, b));
  }
  return stretch;
}

}  // namespace

double depth_behind_m(const ObjectSurface& object, const Eigen::Vector3d& place_m, const Eigen::Vector3d& towards,
                      CellShape shape) noexcept {
  constexpr int kMostFlights = 64;
  constexpr double kMarginCells = 2.0;
  Eigen::AlignedBox3d box_m = object.box_m;
  if (box_m.isEmpty() || !place_m.allFinite()) return 0.0;
  box_m.min().array() -= kMarginCells * object.spacing_m;
  box_m.max().array() += kMarginCells * object.spacing_m;
  const Stretch stretch = stretch_in(box_m, place_m, towards);
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
