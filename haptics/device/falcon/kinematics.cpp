#include "haptics/device/falcon/kinematics.h"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace sparsha::haptics::falcon {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Lengths in metres, named as in Stamper's thesis.
constexpr double kThigh = 0.060;             // a
constexpr double kShin = 0.1025;             // b
constexpr double kPlateToShin = 0.01443;     // c
constexpr double kShinEnds = 2.0 * 0.01125;  // d + e
constexpr double kShinOffset = -0.025;       // f
constexpr double kBaseRadius = 0.0400;       // r
constexpr double kBaseOffset = -0.02309;     // s
constexpr std::array<double, 3> kAzimuthDegrees = {105.0, -15.0, -135.0};

// Encoder: 320 slots read fourfold a motor turn; the capstan of 14.25 mm drives a sector of 110 mm.
constexpr double kCountsPerTurn = 320.0 * 4.0 * 110.0 / 14.25;
constexpr double kRadianPerCount = 2.0 * std::numbers::pi / kCountsPerTurn;
constexpr double kOffset_rad = 35.0 * kDegree;

struct Azimuth {
  double cosine;
  double sine;
};
const std::array<Azimuth, 3> kAzimuths = [] {
  std::array<Azimuth, 3> result{};
  for (std::size_t leg = 0; leg < 3; ++leg)
    result[leg] = {std::cos(kAzimuthDegrees[leg] * kDegree), std::sin(kAzimuthDegrees[leg] * kDegree)};
  return result;
}();

/// One leg's three joint angles.
struct Leg {
  double theta1 = 0.0;
  double theta2 = 0.0;
  double sine3 = 0.0;
  double cosine3 = 0.0;
};

std::optional<Leg> solve_leg(const Azimuth& azimuth, const Eigen::Vector3d& grip_m) noexcept {
  const double u = grip_m.x() * azimuth.cosine + grip_m.y() * azimuth.sine - kBaseRadius;
  const double v = -grip_m.x() * azimuth.sine + grip_m.y() * azimuth.cosine - kBaseOffset;
  const double w = grip_m.z();
  Leg leg;
  leg.cosine3 = (v + kShinOffset) / kShin;
  if (!(std::abs(leg.cosine3) < 1.0)) return std::nullopt;
  leg.sine3 = std::sqrt(1.0 - leg.cosine3 * leg.cosine3);
  const double reach = kShinEnds + kShin * leg.sine3;
  const double across = u + kPlateToShin;
  const double squared = across * across + w * w;
  const double cosine = (squared + kThigh * kThigh - reach * reach) / (2.0 * kThigh * std::sqrt(squared));
  if (!(std::abs(cosine) <= 1.0)) return std::nullopt;
  leg.theta1 = std::atan2(w, across) - std::acos(cosine);
  leg.theta2 = std::atan2(w - kThigh * std::sin(leg.theta1), across - kThigh * std::cos(leg.theta1));
  return leg;
}

// Angles and their derivatives together: Newton needs both. The derivative of the closure along theta3 and theta2 drops
// out when projected on the shin's direction n.
bool angles_and_jacobian(const Eigen::Vector3d& grip_m, Eigen::Vector3d& angles, Eigen::Matrix3d& derivative) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    const Azimuth& azimuth = kAzimuths[i];
    const std::optional<Leg> leg = solve_leg(azimuth, grip_m);
    if (!leg) return false;
    const double nu = std::cos(leg->theta2) * leg->sine3;
    const double nv = leg->cosine3;
    const double nw = std::sin(leg->theta2) * leg->sine3;
    const double lever = kThigh * leg->sine3 * std::sin(leg->theta2 - leg->theta1);
    const auto row = static_cast<Eigen::Index>(i);
    angles[row] = leg->theta1;
    derivative.row(row) << (nu * azimuth.cosine - nv * azimuth.sine) / lever,
        (nu * azimuth.sine + nv * azimuth.cosine) / lever, nw / lever;
  }
  return derivative.allFinite();
}

}  // namespace

Eigen::Vector3d angles_from_counts(const Counts& counts) noexcept {
  Eigen::Vector3d angles;
  for (std::size_t i = 0; i < 3; ++i)
    angles[static_cast<Eigen::Index>(i)] = kOffset_rad + kRadianPerCount * static_cast<double>(counts[i]);
  return angles;
}

Counts counts_from_angles(const Eigen::Vector3d& angles) noexcept {
  Counts counts{};
  for (std::size_t i = 0; i < 3; ++i)
    counts[i] = static_cast<int>(std::lround((angles[static_cast<Eigen::Index>(i)] - kOffset_rad) / kRadianPerCount));
  return counts;
}

std::optional<Eigen::Vector3d> inverse(const Eigen::Vector3d& position_m) noexcept {
  Eigen::Vector3d angles;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<Leg> leg = solve_leg(kAzimuths[i], position_m);
    if (!leg) return std::nullopt;
    angles[static_cast<Eigen::Index>(i)] = leg->theta1;
  }
  return angles;
}

std::optional<Eigen::Matrix3d> jacobian(const Eigen::Vector3d& position_m) noexcept {
  Eigen::Vector3d angles;
  Eigen::Matrix3d derivative;
  if (!angles_and_jacobian(position_m, angles, derivative)) return std::nullopt;
  return derivative;
}

std::optional<Eigen::Vector3d> forward(const Eigen::Vector3d& angles, const Eigen::Vector3d& start_m) noexcept {
  constexpr int kIterations = 40;
  constexpr int kHalvings = 12;
  constexpr double kSettled_rad = 1e-11;
  constexpr double kLongestStep_m = 0.03;
  if (!angles.allFinite()) return std::nullopt;
  Eigen::Vector3d position = start_m;
  Eigen::Vector3d reached;
  Eigen::Matrix3d derivative;
  if (!angles_and_jacobian(position, reached, derivative)) {
    position = kNeutral_m;
    if (!angles_and_jacobian(position, reached, derivative)) return std::nullopt;
  }
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Vector3d missing = angles - reached;
    if (missing.cwiseAbs().maxCoeff() <= kSettled_rad) return position;
    Eigen::Vector3d step = derivative.inverse() * missing;
    if (!step.allFinite()) return std::nullopt;
    const double length = step.norm();
    if (length > kLongestStep_m) step *= kLongestStep_m / length;
    // Halve until the step stays where a grip can be and comes nearer.
    bool nearer = false;
    for (int halving = 0; halving < kHalvings && !nearer; ++halving, step *= 0.5) {
      Eigen::Vector3d tried;
      Eigen::Matrix3d tried_derivative;
      nearer = angles_and_jacobian(position + step, tried, tried_derivative) &&
               (angles - tried).squaredNorm() < missing.squaredNorm();
      if (!nearer) continue;
      position += step;
      reached = tried;
      derivative = tried_derivative;
    }
    if (!nearer) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> torques(const Eigen::Vector3d& position_m, const Eigen::Vector3d& force_n) noexcept {
  const std::optional<Eigen::Matrix3d> derivative = jacobian(position_m);
  if (!derivative) return std::nullopt;
  const Eigen::Vector3d result = derivative->transpose().inverse() * force_n;
  if (!result.allFinite()) return std::nullopt;
  return result;
}

}  // namespace sparsha::haptics::falcon
