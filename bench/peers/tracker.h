// The proxy on an implicit surface: along the tangent plane towards the hand, then back to the surface along the
// normal. K. Salisbury, C. Tarr, "Haptic rendering of surfaces defined by implicit functions", ASME 1997.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace sparsha::bench {

/// A field near its surface: first-order distance and unit normal. Not `near`: free space, or nothing known.
struct FieldValue {
  double distance_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  bool near = false;
};

struct TrackerOptions {
  int iterations = 20;  ///< tangent steps per tick, at most
  double tolerance_spacings = 1e-3;
};

/// field(point) -> FieldValue. `reach_m`: within which one evaluation tells something.
template <class Field>
class Tracker {
 public:
  void place(const Eigen::Vector3d& hand) {
    proxy = hand;
    contact = false;
  }
  void update(const Field& field, const Eigen::Vector3d& hand, const TrackerOptions& options, double spacing_m) {
    const double tolerance = options.tolerance_spacings * spacing_m;
    for (int k = 0; k < options.iterations; ++k) {
      if (!contact && !march(field, hand)) return;
      const FieldValue here = field(proxy);
      if (!here.near) {  // over the border
        contact = false;
        proxy = hand;
        return;
      }
      const Eigen::Vector3d pull = hand - proxy;
      const double out = pull.dot(here.normal);
      if (out > 0.0) {
        contact = false;
        continue;
      }
      Eigen::Vector3d step = pull - out * here.normal;
      const double length = step.norm();
      if (length < tolerance) return;
      if (length > spacing_m) step *= spacing_m / length;
      const Eigen::Vector3d before = proxy;
      proxy += step;
      settle(field, tolerance);
      if ((proxy - before).norm() < tolerance) return;
    }
  }

  Eigen::Vector3d proxy = Eigen::Vector3d::Zero();
  bool contact = false;

 private:
  void settle(const Field& field, double tolerance) {
    for (int k = 0; k < 4; ++k) {
      const FieldValue value = field(proxy);
      if (!value.near) return;
      proxy -= value.distance_m * value.normal;
      if (std::abs(value.distance_m) < tolerance) return;
    }
  }
  /// Through free space towards the hand in steps below the field's reach; true when the surface was met.
  bool march(const Field& field, const Eigen::Vector3d& hand) {
    const Eigen::Vector3d way = hand - proxy;
    const int steps = static_cast<int>(std::min(10000.0, std::ceil(way.norm() / field.reach_m())));
    const Eigen::Vector3d start = proxy;
    for (int k = 1; k <= steps; ++k) {
      const Eigen::Vector3d there = start + way * (static_cast<double>(k) / steps);
      const FieldValue value = field(there);
      if (!value.near || value.distance_m >= 0.0) continue;
      double low = (k - 1.0) / steps;
      double high = static_cast<double>(k) / steps;
      for (int halving = 0; halving < 20; ++halving) {
        const double middle = 0.5 * (low + high);
        const FieldValue between = field(start + way * middle);
        (between.near && between.distance_m < 0.0 ? high : low) = middle;
      }
      proxy = start + way * low;
      contact = true;
      return true;
    }
    proxy = hand;
    return false;
  }
};

}  // namespace sparsha::bench
