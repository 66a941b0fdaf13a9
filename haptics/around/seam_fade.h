// What is left of the way that the proxy was moved by when it went over from one sheet to the next.
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace sparsha::haptics {

/// What two sheets differ by where the proxy went over from one to the next. It fades while the proxy goes on.
struct SeamFade {
  Eigen::Vector3d apart_m = Eigen::Vector3d::Zero();  ///< object frame
  double arm_m = 0.0;  ///< from hand to proxy where that was; a hand less deep feels as much less of it
  double left = 0.0;   ///< cells that the proxy has to go on until none is left

  /// After a hand-over: nothing where the places of rest lie further apart than a seam of one surface.
  [[nodiscard]] static SeamFade of(const Eigen::Vector3d& apart_m, double hand_arm_m, double spacing_m) noexcept {
    constexpr double kSeamCells = 2.0;  // that it fades over
    constexpr double kMostSeam = 0.35;  // cells that it may be
    constexpr double kMostShare = 0.5;  // and of the way from hand to proxy
    const double most_m = std::min(kMostSeam * spacing_m, kMostShare * hand_arm_m);
    return apart_m.norm() <= most_m ? SeamFade{apart_m, hand_arm_m, kSeamCells} : SeamFade{};
  }
  /// The proxy has gone on by so many cells.
  void go_on(double cells) noexcept {
    if (!(left > 0.0)) return;
    const double rest = std::max(0.0, left - cells);
    apart_m *= rest / left;
    left = rest;
  }
  /// What is felt of it with this much between hand and proxy.
  [[nodiscard]] Eigen::Vector3d felt_m(double hand_arm_m) const noexcept {
    if (!(left > 0.0)) return Eigen::Vector3d::Zero();
    return std::min(1.0, hand_arm_m / arm_m) * apart_m;
  }
};

}  // namespace sparsha::haptics
