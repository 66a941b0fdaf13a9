// Petals, beads, mouldings and the pod.
#include "pipeline/simulate/ornament.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/numbers/smooth_step.h"
#include "pipeline/simulate/plain_math.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFlank = 2.0;  // slope of the flanks of petals: steep, yet a finger and a scanner reach the bottom

double squared(double x) { return x * x; }

/// Half width of a petal over its length, 0 to 1 along s: narrow root, full shoulders, a short point.
double petal_outline(double s) {
  constexpr double kWidest = 0.60;
  if (s < kWidest) return 0.50 + 0.50 * plain::sin_turns(0.25 * std::max(0.0, s) / kWidest);
  const double t = std::min(1.0, (s - kWidest) / (1.0 - kWidest));
  const double round = std::sqrt(1.0 - t * t);
  return round * std::sqrt(round) * (1.0 - 0.10 * plain::sin_turns(0.5 * t));
}

double half_ball_z(double ball, double squared_distance) {
  // A little less than a full half ball stands out; outside it falls away.
  const double inside = ball * ball - squared_distance;
  return inside > 0.0 ? std::sqrt(inside) : -kFlank * (std::sqrt(squared_distance) - ball);
}

}  // namespace

double soft_max(double a, double b, double soft) {
  const double overlap = std::max(0.0, soft - std::fabs(a - b));
  return std::max(a, b) + 0.25 * overlap * overlap / soft;
}

double smooth_ramp(double low, double high, double x) { return smooth_step((x - low) / (high - low)); }

double petal_z(const Petal& petal, double u, double v) {
  const double length = petal.tip - petal.root;
  const double s = (u - petal.root) / length;
  const double half = petal.half_width * petal_outline(s);
  const double beyond = std::max({0.0, u - petal.tip, petal.root - u});
  // Distance to the outline, inwards; the sides of the point are oblique, hence the factor.
  const double edge = 0.8 * (half - std::fabs(v)) - beyond;
  constexpr double kRound = 0.0016;  // of the rim's outer edge
  const double missing = std::max(0.0, kRound - edge);
  const double flank =
      missing < kRound ? kFlank * squared(missing) / (2.0 * kRound) : kFlank * (missing - 0.5 * kRound);
  const double along = std::clamp(s, 0.0, 1.0);
  double z =
      petal.base + petal.rise * plain::sin_turns(0.5 * std::min(1.0, 1.15 * along)) - petal.droop * along * along;
  const double across = half > 0.0 ? std::min(1.0, squared(v / half)) : 1.0;
  const double fade = smooth_ramp(0.0, 0.004, edge);
  const double hollow = 0.0019 * (1.0 - across) * fade;
  const double rim = 0.0007 * plain::exp(-squared((edge - 0.0019) / 0.0009));
  const double midrib = 0.0011 * (1.0 - 0.6 * along) * plain::exp(-squared(v / 0.0010)) * fade;
  const double ribs = 0.00013 * plain::cos_turns(v / 0.0027) * fade;
  z += rim + midrib + ribs - hollow;
  return z - flank;
}

double petal_ring_z(const Petal& petal, int count, double phase, double radius, double angle_turns) {
  const double sector = angle_turns * count - phase;
  const double angle = (sector - std::floor(sector + 0.5)) / count;
  return petal_z(petal, radius * plain::cos_turns(angle), radius * plain::sin_turns(angle));
}

double bead_ring_z(double ball, double ring, int count, double radius, double angle_turns) {
  const double sector = angle_turns * count;
  const double angle = (sector - std::floor(sector + 0.5)) / count;
  const double along = 2.0 * std::numbers::pi * ring * angle;
  return half_ball_z(ball, squared(radius - ring) + squared(along));
}

double torus_z(double z, double half_width, double distance) {
  const double inside = half_width * half_width - distance * distance;
  if (inside > 0.0) return z - half_width + std::sqrt(inside);
  return z - half_width - kFlank * (std::fabs(distance) - half_width);
}

double pod_z(double drum_radius, double z, double radius, double angle_turns) {
  const double edge = drum_radius - radius;
  double drum = z + 0.0012 * (1.0 - squared(radius / drum_radius));
  if (edge < 0.0015) drum -= kFlank * std::max(0.0, 0.0015 - edge);
  drum += 0.0008 * plain::exp(-squared((edge - 0.0022) / 0.0010));  // rim
  const double seed = 0.0021;
  double seeds = half_ball_z(seed, squared(radius));
  seeds = std::max(seeds, bead_ring_z(seed, 0.34 * drum_radius, 6, radius, angle_turns));
  seeds = std::max(seeds, bead_ring_z(seed, 0.66 * drum_radius, 12, radius, angle_turns));
  return seeds > 0.0 ? drum + 0.7 * seeds : drum - 0.0006 * smooth_ramp(-0.003, 0.0, seeds);
}

}  // namespace sparsha::pipeline
