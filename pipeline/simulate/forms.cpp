// Sinusoid, accuracy scene, bars, facade and hall.
#include "pipeline/simulate/forms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/simulate/noise_field.h"
#include "pipeline/simulate/plain_math.h"

namespace sparsha::pipeline {
namespace {

/// A line a x + b y = c with unit normal (a, b).
struct Line {
  double a, b, c;
  [[nodiscard]] double signed_distance(double x, double y) const { return a * x + b * y - c; }
};

constexpr Line kStep{0.96, 0.28, 0.78};  // upper side to the right
constexpr std::array<Line, 3> kGrooves{{{-0.08, 0.9968, 0.16}, {0.6, 0.8, 1.21}, {0.9968, 0.08, 0.115}}};
constexpr double kRingX = 0.36, kRingY = 0.60, kRingRadius = 0.14;  // a fourth groove, round

struct Dome {
  double x, y, sigma, height;
};
constexpr std::array<Dome, 4> kDomes{
    {{0.30, 0.66, 0.13, 0.042}, {0.55, 0.30, 0.09, -0.026}, {0.86, 0.72, 0.10, 0.030}, {0.20, 0.22, 0.07, 0.018}}};

double ring_distance(double x, double y) {
  const double dx = x - kRingX;
  const double dy = y - kRingY;
  return std::fabs(std::sqrt(dx * dx + dy * dy) - kRingRadius);
}

/// Depth of a V at distance `d` from its bottom line.
double groove(const AccuracyForm& form, double d) {
  return form.groove_m * std::max(0.0, 1.0 - 2.0 * d / form.groove_width_m);
}

double bar_offset(const BarsForm& form, double x, double y) {
  constexpr double kSlant = 0.3;
  const double u = form.slanted ? (x - kSlant * y) / std::sqrt(1.0 + kSlant * kSlant) : x;
  const double turns = u / form.pitch_m;
  return std::fabs(turns - std::floor(turns) - 0.5) * form.pitch_m;  // from the middle of the nearest bar
}

// The facade: one window every kBay metres and kStorey metres, a sill below it, a string course between storeys.
constexpr double kBay = 2.0, kStorey = 2.5;
constexpr double kWindowHalfWidth = 0.5, kWindowLow = 0.8, kWindowHigh = 2.1;
constexpr double kSillHalfWidth = 0.62, kSillLow = 0.70, kSillDepth = 0.06;
constexpr double kCourseRadius = 0.05;

struct BayPlace {
  double u;  // from the bay's middle
  double v;  // above the storey's floor
};
BayPlace bay_place(double x, double y) {
  return {x - kBay * (std::floor(x / kBay) + 0.5), y - kStorey * std::floor(y / kStorey)};
}

/// Distance to the border of the box |u| <= half, low <= v <= high.
double box_border(double u, double v, double half, double low, double high) {
  const double across = std::fabs(u) - half;
  const double along = std::max(low - v, v - high);
  if (across <= 0.0 && along <= 0.0) return -std::max(across, along);
  const double a = std::max(across, 0.0);
  const double b = std::max(along, 0.0);
  return std::sqrt(a * a + b * b);
}

// The hall: bases and capitals are thicker by a third over a twelfth of the height.
constexpr double kCollar = 1.3, kCollarHeight = 1.0 / 12.0;
constexpr std::uint64_t kHallSeed = 0x4A11;

struct HallPillar {
  double x = 0.0;       // of its axis
  double radius = 0.0;  // at the height asked for
};
/// The one whose axis is nearest to x.
HallPillar nearest_pillar(const HallForm& form, double width, double height, double x, double y) {
  const int all = form.minor + 1;
  const int middle = (form.minor + 1) / 2;
  const double pitch = width / all;
  const int k = std::clamp(static_cast<int>(std::floor(x / pitch)), 0, all - 1);
  const bool collar = y < kCollarHeight * height || y > (1.0 - kCollarHeight) * height;
  return {(k + 0.5) * pitch, (k == middle ? form.major_m : form.minor_m) * (collar ? kCollar : 1.0)};
}

}  // namespace

double hall_z(const HallForm& form, double width, double height, double x, double y) {
  const double size = 0.01;  // metres a grain
  const double grain = form.grain_m * fractal_noise(kHallSeed, x / size, y / size, 4, 0.6);
  const HallPillar pillar = nearest_pillar(form, width, height, x, y);
  const double dx = x - pillar.x;
  if (std::fabs(dx) >= pillar.radius) return grain;
  return grain + form.gap_m + std::sqrt(pillar.radius * pillar.radius - dx * dx);
}

double hall_step_distance(const HallForm& form, double width, double height, double x, double y) {
  const HallPillar pillar = nearest_pillar(form, width, height, x, y);
  const double flank = std::fabs(std::fabs(x - pillar.x) - pillar.radius);
  const double collar = kCollarHeight * height;
  return std::min({flank, std::fabs(y - collar), std::fabs(height - collar - y)});
}

std::array<double, 2> form_range(const HallForm& form) {
  return {-4.0 * form.grain_m, form.gap_m + kCollar * std::max(form.major_m, form.minor_m) + 4.0 * form.grain_m};
}

double form_z(const SinusoidForm& form, double x, double y) {
  return form.amplitude_m * plain::sin_turns(x / form.wavelength_m) * plain::sin_turns(y / form.wavelength_m);
}

double form_z(const AccuracyForm& form, double x, double y) {
  double z = 0.012 * plain::sin_turns(1.3 * x + 0.1) * plain::cos_turns(0.9 * y);
  for (const Dome& dome : kDomes) {
    const double dx = x - dome.x;
    const double dy = y - dome.y;
    z += dome.height * plain::exp(-0.5 * (dx * dx + dy * dy) / (dome.sigma * dome.sigma));
  }
  for (const Line& line : kGrooves) z -= groove(form, std::fabs(line.signed_distance(x, y)));
  z -= groove(form, ring_distance(x, y));
  return kStep.signed_distance(x, y) > 0.0 ? z + form.step_m : z;
}

double form_step_distance(const AccuracyForm&, double x, double y) { return std::fabs(kStep.signed_distance(x, y)); }

double form_groove_distance(const AccuracyForm& form, double x, double y) {
  const double half = 0.5 * form.groove_width_m;
  double nearest = std::numeric_limits<double>::infinity();
  const auto take = [&](double d) { nearest = std::min({nearest, d, std::fabs(d - half)}); };
  for (const Line& line : kGrooves) take(std::fabs(line.signed_distance(x, y)));
  take(ring_distance(x, y));
  return nearest;
}

std::array<double, 2> form_range(const AccuracyForm& form) {
  double low = -0.012 - 4.0 * form.groove_m + std::min(0.0, form.step_m);
  double high = 0.012 + std::max(0.0, form.step_m);
  for (const Dome& dome : kDomes) (dome.height < 0.0 ? low : high) += dome.height;
  return {low, high};
}

double form_z(const BarsForm& form, double x, double y) {
  return bar_offset(form, x, y) < 0.5 * form.width_m ? form.bar_m : 0.0;
}

double form_step_distance(const BarsForm& form, double x, double y) {
  return std::fabs(bar_offset(form, x, y) - 0.5 * form.width_m);
}

double form_z(const FacadeForm& form, double x, double y) {
  const auto [u, v] = bay_place(x, y);
  if (std::fabs(u) <= kWindowHalfWidth && v >= kWindowLow && v <= kWindowHigh) {
    return -form.window_m + 0.01 * plain::cos_turns(u / 0.25) * plain::cos_turns(v / 0.26);
  }
  if (std::fabs(u) <= kSillHalfWidth && v >= kSillLow && v < kWindowLow) return kSillDepth;
  const double across = std::min(v, kStorey - v);
  double z = 0.004 * plain::sin_turns(x / 3.1) * plain::sin_turns(y / 2.3);
  if (across < kCourseRadius) z += std::sqrt(kCourseRadius * kCourseRadius - across * across);
  return z;
}

double form_step_distance(const FacadeForm&, double x, double y) {
  const auto [u, v] = bay_place(x, y);
  const double course = std::fabs(std::min(v, kStorey - v) - kCourseRadius);  // where the moulding leaves the wall
  return std::min({box_border(u, v, kWindowHalfWidth, kWindowLow, kWindowHigh),
                   box_border(u, v, kSillHalfWidth, kSillLow, kWindowLow), course});
}

std::array<double, 2> form_range(const FacadeForm& form) {
  return {std::min(-form.window_m - 0.01, -0.01), std::max({kSillDepth, 0.004 + kCourseRadius, 0.01 - form.window_m})};
}

}  // namespace sparsha::pipeline
