// What a Falcon is for the servo: its force, its workspace, and what is not known of it.
#include <algorithm>

#include <fmt/format.h>

#include "haptics/device/falcon/calibration.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/kinematics.h"
#include "haptics/device/falcon/packet.h"

namespace sparsha::haptics::falcon {
namespace {

/// More is not asked of a hand-held device of this size, whatever its motors have.
constexpr double kMostForce_n = 5.0;
constexpr double kForceRadius_m = 0.035;
/// Counts per newton metre along z and sideways in traces of the maker's software, if their unit is the newton and
/// their place z = 0.12 m; neither is known.
constexpr double kLeastSuggested = 2300.0, kMostSuggested = 4400.0;

/// The greatest force that the amplifiers deliver in every direction, anywhere within kForceRadius_m of the origin: no
/// motor's share of a newton in its worst direction may pass its range.
double force_everywhere_n(const FalconOptions& options) {
  constexpr int kSteps = 8;  // from the middle to the rim
  double least_n = kMostForce_n;
  for (int i = -kSteps; i <= kSteps; ++i)
    for (int j = -kSteps; j <= kSteps; ++j)
      for (int k = -kSteps; k <= kSteps; ++k) {
        const Eigen::Vector3d offset_m = Eigen::Vector3d(i, j, k) * (kForceRadius_m / kSteps);
        if (offset_m.norm() > kForceRadius_m * (1.0 + 1e-9)) continue;
        Eigen::Matrix3d torques_per_n;
        for (int axis = 0; axis < 3; ++axis) {
          const auto torque = torques(options.centre_m + offset_m, Eigen::Vector3d::Unit(axis));
          if (!torque) return 0.0;
          torques_per_n.col(axis) = *torque;
        }
        const double most = torques_per_n.rowwise().norm().maxCoeff() * counts_of(options);
        least_n = std::min(least_n, kMostCommand / most);
      }
  return least_n;
}

}  // namespace

double counts_of(const FalconOptions& options) {
  return options.counts_per_newton_metre > 0.0 ? options.counts_per_newton_metre : kUsualCounts;
}

DeviceInfo falcon_info(const FalconOptions& options) {
  DeviceInfo info;
  info.name = "Novint Falcon";
  info.workspace_width_m = 0.070;
  info.limits.max_force_n = force_everywhere_n(options);
  info.limits.least_damping_n_s_per_m = 2.0;
  // Each answer tells the loop's delay but for the firmware's own cycle and the motors
  // (docs/change/decisions/0021-undeclared-delay-of-a-falcon.md).
  info.limits.undeclared_s = 0.001;
  info.limits.encoder_step_m = 70e-6;  // of the grip, two or three counts at once, anywhere in the workspace
  info.paced = true;
  info.fastest_m_per_s = 5.0;
  if (!(options.counts_per_newton_metre > 0.0))
    info.warning = fmt::format(
        "The Falcon was never calibrated: forces may be up to {:.0f} times what they should be ({:.0f} motor "
        "counts per newton metre are assumed, traces of the maker's software suggest {:.0f} to {:.0f}); run "
        "sparsha device calibrate",
        kUsualCounts / kLeastSuggested, kUsualCounts, kLeastSuggested, kMostSuggested);
  return info;
}

}  // namespace sparsha::haptics::falcon
