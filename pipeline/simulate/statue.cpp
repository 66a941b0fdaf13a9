// Distances of round parts, joined smoothly (Quilez, "Distance functions" and "Smooth minimum"). Arithmetic and roots
// alone, so that scans are the same on every machine. Lengths are in hundredths of the drawn metre; y is up, z the
// front.
#include "pipeline/simulate/statue.h"

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kUnits = 100.0 * kStatueHeight_m;  // of the height

/// The smaller of two distances; surfaces that are nearer than `k` to each other flow together.
double join(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

double ball(const Vector3d& p, const Vector3d& centre, double radius) { return (p - centre).norm() - radius; }

double limb(const Vector3d& p, const Vector3d& a, const Vector3d& b, double radius) {
  const Vector3d along = b - a, from = p - a;
  const double share = std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (from - share * along).norm() - radius;
}

/// Two balls and the cone that touches both.
double taper(const Vector3d& p, const Vector3d& a, const Vector3d& b, double at_a, double at_b) {
  const auto sign = [](double x) { return x < 0.0 ? -1.0 : 1.0; };
  const Vector3d along = b - a, from = p - a;
  const double l2 = along.squaredNorm(), narrower = at_a - at_b;
  const double a2 = l2 - narrower * narrower;
  const double y = from.dot(along), z = y - l2;
  const double x2 = (from * l2 - along * y).squaredNorm();
  const double y2 = y * y * l2, z2 = z * z * l2;
  const double k = sign(narrower) * narrower * narrower * x2;
  if (sign(z) * a2 * z2 > k) return std::sqrt(x2 + z2) / l2 - at_b;
  if (sign(y) * a2 * y2 < k) return std::sqrt(x2 + y2) / l2 - at_a;
  return (std::sqrt(x2 * a2 / l2) + y * narrower) / l2 - at_a;
}

/// A ring about an axis through `centre`: 1 for y, 2 for z.
double ring(const Vector3d& p, const Vector3d& centre, int axis, double radius, double thickness) {
  const Vector3d q = p - centre;
  const double across = axis == 1 ? std::sqrt(q.x() * q.x() + q.z() * q.z()) : std::sqrt(q.x() * q.x() + q.y() * q.y());
  const double out = across - radius;
  return std::sqrt(out * out + q[axis] * q[axis]) - thickness;
}

double plinth(const Vector3d& p) {
  constexpr double kRadius = 6.6, kHalf = 1.5, kRound = 0.5;
  const double out = std::sqrt(p.x() * p.x() + p.z() * p.z()) - kRadius + kRound;
  const double up = std::abs(p.y() - kHalf) - kHalf + kRound;
  const double beside = std::max(out, 0.0), above = std::max(up, 0.0);
  return std::sqrt(beside * beside + above * above) + std::min(std::max(out, up), 0.0) - kRound;
}

/// A skirt with nine pleats, deepest at its hem.
double skirt(const Vector3d& p) {
  const double cone = taper(p, {0.0, 4.0, 0.0}, {0.0, 14.5, 0.0}, 4.2, 2.5);
  const double r2 = p.x() * p.x() + p.z() * p.z();
  if (r2 < 1.0) return cone;
  // The cosine of nine times the angle, as a polynomial of the cosine.
  const double c = p.z() / std::sqrt(r2), c2 = c * c;
  const double nine = c * (9.0 + c2 * (-120.0 + c2 * (432.0 + c2 * (-576.0 + c2 * 256.0))));
  const double depth = 0.2 * std::clamp((15.0 - p.y()) / 9.0, 0.0, 1.0);
  return cone - depth * nine;
}

double head(const Vector3d& p) {
  double d = join(ball(p, {0.0, 27.6, 0.3}, 2.35), ball(p, {0.0, 26.3, 0.9}, 1.5), 0.8);
  d = join(d, taper(p, {0.0, 27.9, 2.3}, {0.0, 27.0, 2.75}, 0.28, 0.4), 0.35);
  for (const double side : {-1.0, 1.0}) {
    d = join(d, ball(p, {side * 0.9, 28.0, 2.15}, 0.42), 0.15);
    d = join(d, ball(p, {side * 2.3, 27.4, 0.1}, 0.6), 0.3);
  }
  d = join(d, limb(p, {-0.45, 26.1, 2.25}, {0.45, 26.1, 2.25}, 0.22), 0.25);
  return join(d, ball(p, {0.0, 30.0, -0.8}, 1.35), 0.4);
}

double arms(const Vector3d& p) {
  const double hip = join(limb(p, {4.2, 22.4, 0.0}, {6.8, 18.8, -0.8}, 0.95),
                          taper(p, {6.8, 18.8, -0.8}, {2.9, 15.2, 1.0}, 0.9, 0.65), 0.4);
  double raised = join(limb(p, {-4.2, 22.4, 0.0}, {-6.6, 25.4, 0.5}, 0.95),
                       taper(p, {-6.6, 25.4, 0.5}, {-5.3, 30.2, 1.2}, 0.9, 0.6), 0.4);
  raised = join(raised, ball(p, {-5.2, 30.8, 1.3}, 0.85), 0.4);
  raised = join(raised, ring(p, {-5.1, 33.6, 1.4}, 2, 1.9, 0.42), 0.3);
  return std::min(hip, raised);
}

double figure(const Vector3d& p) {
  double d = taper(p, {0.0, 14.8, 0.0}, {0.0, 21.2, 0.3}, 2.3, 2.9);
  d = join(d, limb(p, {-3.4, 22.4, 0.0}, {3.4, 22.4, 0.0}, 1.3), 1.2);
  d = join(d, limb(p, {0.0, 22.5, 0.1}, {0.0, 25.5, 0.2}, 1.05), 0.9);
  d = join(d, arms(p), 0.6);
  d = join(d, head(p), 0.5);
  d = join(d, skirt(p), 0.5);
  d = join(d, ring(p, {0.0, 15.4, 0.0}, 1, 2.55, 0.5), 0.2);
  for (const double side : {-1.0, 1.0}) d = join(d, limb(p, {side * 1.7, 3.5, 2.6}, {side * 2.0, 3.3, 4.7}, 0.85), 0.3);
  return join(d, plinth(p), 0.4);
}

Vector3d units_of(double width_m, double height_m, const Vector3d& place_m) {
  const double units = kUnits / height_m;
  return {(place_m.x() - 0.5 * width_m) * units, place_m.y() * units, place_m.z() * units};
}

}  // namespace

double statue_distance_m(double width_m, double height_m, const Vector3d& place_m) {
  return figure(units_of(width_m, height_m, place_m)) * height_m / kUnits;
}

double statue_depth_m(double height_m) { return kStatueDepth_m * height_m / kStatueHeight_m; }

std::optional<double> meet_statue(double width_m, double height_m, const Vector3d& origin_m,
                                  const Vector3d& direction) {
  constexpr double kAround = 0.6;  // radius of a ball about the statue's middle, of its height
  constexpr double kSafe = 0.7;    // pleats make distances too large
  constexpr double kTolerance = 1e-9;
  constexpr int kMostSteps = 2000;
  const Vector3d middle(0.5 * width_m, 0.5 * height_m, 0.0);
  const double radius = kAround * height_m;
  const double nearest = (middle - origin_m).dot(direction);
  const double off2 = (middle - origin_m).squaredNorm() - nearest * nearest;
  if (off2 > radius * radius) return std::nullopt;
  const double half = std::sqrt(radius * radius - off2);
  double t = std::max(0.0, nearest - half);
  for (int step = 0; step < kMostSteps && t < nearest + half; ++step) {
    const double clear = statue_distance_m(width_m, height_m, origin_m + t * direction);
    if (clear < kTolerance * height_m) return t;
    t += kSafe * clear;
  }
  return std::nullopt;
}

}  // namespace sparsha::pipeline
