// A leg closes when the distance from its elbow to the platform's joint, within the plane of the arm, equals the length
// that its parallelogram shows there. Everything below is this one equation per leg.
#include "emulator/geometry.h"

#include <cmath>
#include <numbers>

namespace sparsha::emulator {
namespace {

constexpr double kThigh_m = 0.060, kShin_m = 0.1025, kPlatform_m = 0.01443, kHinges_m = 2 * 0.01125, kSkew_m = -0.025;
constexpr double kBaseRadius_m = 0.0400, kBaseOffset_m = -0.02309;
constexpr std::array<double, 3> kAzimuth_deg{105.0, -15.0, -135.0};
constexpr double kRadians = std::numbers::pi / 180.0;
/// 320 slots, four edges each; a 14.25 mm capstan on a sector of 110 mm.
constexpr double kDegreesPerCount = 360.0 / (4 * 320 * 110.0 / 14.25);
constexpr double kDegreesAtZero = 35.0;

/// The platform's joint as leg `i` sees it: outwards, sideways, forwards.
struct Joint {
  double out, side, forward;
  double cosine, sine;  // of the azimuth
};

Joint joint_of(std::size_t i, const Vec3& p) {
  const double cosine = std::cos(kAzimuth_deg[i] * kRadians), sine = std::sin(kAzimuth_deg[i] * kRadians);
  return {p[0] * cosine + p[1] * sine - kBaseRadius_m + kPlatform_m,
          p[1] * cosine - p[0] * sine - kBaseOffset_m + kSkew_m, p[2], cosine, sine};
}

/// What the shin spans within the arm's plane; negative where it does not reach sideways.
double span_of(const Joint& joint) {
  const double rest = kShin_m * kShin_m - joint.side * joint.side;
  return rest > 0.0 ? kHinges_m + std::sqrt(rest) : -1.0;
}

/// The closure's residual for an arm angle, metres, its gradient in place and its derivative in angle.
struct Closure {
  double residual, by_angle;
  Vec3 by_place;
};

std::optional<Closure> closure(std::size_t i, const Vec3& p, double angle) {
  const Joint joint = joint_of(i, p);
  const double span = span_of(joint);
  if (span < 0.0) return std::nullopt;
  const double x = joint.out - kThigh_m * std::cos(angle), z = joint.forward - kThigh_m * std::sin(angle);
  const double distance = std::hypot(x, z);
  if (distance < 1e-9) return std::nullopt;
  const double by_out = x / distance, by_forward = z / distance, by_side = joint.side / (span - kHinges_m);
  return Closure{
      distance - span,
      kThigh_m * (x * std::sin(angle) - z * std::cos(angle)) / distance,
      {by_out * joint.cosine - by_side * joint.sine, by_out * joint.sine + by_side * joint.cosine, by_forward}};
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

double angle_of(double count) { return (kDegreesAtZero + kDegreesPerCount * count) * kRadians; }

int count_of(double angle_rad) {
  return static_cast<int>(std::lround((angle_rad / kRadians - kDegreesAtZero) / kDegreesPerCount));
}

std::optional<PerArm> arm_angles(const Vec3& grip_m) {
  PerArm angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Joint joint = joint_of(i, grip_m);
    const double span = span_of(joint);
    if (span < 0.0) return std::nullopt;
    // out cos(angle) + forward sin(angle) = k, with t = tan(angle / 2) a quadratic.
    const double reach2 = joint.out * joint.out + joint.forward * joint.forward;
    const double k = (reach2 + kThigh_m * kThigh_m - span * span) / (2.0 * kThigh_m);
    const double root2 = reach2 - k * k;
    if (!(root2 >= 0.0) || k + joint.out == 0.0) return std::nullopt;
    angles[i] = 2.0 * std::atan((joint.forward - std::sqrt(root2)) / (k + joint.out));
  }
  return angles;
}

std::optional<Vec3> grip_place(const PerArm& angles_rad, const Vec3& start_m) {
  Vec3 p = start_m;
  for (int step = 0; step < 50; ++step) {
    std::array<Vec3, 3> rows{};
    Vec3 residual{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto leg = closure(i, p, angles_rad[i]);
      if (!leg) return std::nullopt;
      rows[i] = leg->by_place;
      residual[i] = leg->residual;
    }
    const Vec3 c0 = cross(rows[1], rows[2]), c1 = cross(rows[2], rows[0]), c2 = cross(rows[0], rows[1]);
    const double determinant = dot(rows[0], c0);
    if (std::abs(determinant) < 1e-9) return std::nullopt;
    double change = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double d = -(residual[0] * c0[axis] + residual[1] * c1[axis] + residual[2] * c2[axis]) / determinant;
      p[axis] += d;
      change = std::max(change, std::abs(d));
    }
    if (change < 1e-13) {
      // The closure has mirror images that the joints do not reach.
      const auto angles = arm_angles(p);
      for (std::size_t i = 0; i < 3; ++i)
        if (!angles || std::abs((*angles)[i] - angles_rad[i]) > 1e-9) return std::nullopt;
      return p;
    }
    if (!(change < 1.0)) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<std::array<Vec3, 3>> angle_rates(const Vec3& grip_m) {
  const auto angles = arm_angles(grip_m);
  if (!angles) return std::nullopt;
  std::array<Vec3, 3> rates{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto leg = closure(i, grip_m, (*angles)[i]);
    if (!leg || std::abs(leg->by_angle) < 1e-9) return std::nullopt;
    for (std::size_t axis = 0; axis < 3; ++axis) rates[i][axis] = -leg->by_place[axis] / leg->by_angle;
  }
  return rates;
}

Vec3 force_of(const PerArm& torque_n_m, const Vec3& grip_m) {
  Vec3 force{};
  if (const auto rates = angle_rates(grip_m))
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) force[axis] += (*rates)[i][axis] * torque_n_m[i];
  return force;
}

}  // namespace sparsha::emulator
