// Analytic reliefs and noisy point samples of them, for judging the projection: truth in double, seeded, header-only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace sparsha::test {

/// Points in metres, double, as a scanner would deliver them.
using Points = std::vector<std::array<double, 3>>;

/// z = f(x, y) over the unit square, metres.
using HeightFunction = std::function<double(double, double)>;

/// x of the step's edge at height y.
inline double step_edge_m(double y) { return 0.62 + 0.05 * std::sin(5.0 * y); }

/// Smooth forms of up to 25 mm, without grooves or step.
inline double smooth_forms_m(double x, double y) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return 0.012 * std::sin(kTurn * (1.3 * x + 0.4 * y)) + 0.008 * std::sin(kTurn * (2.1 * y - 0.7 * x) + 1.0) +
         0.003 * std::sin(kTurn * 6.0 * x) * std::sin(kTurn * 5.0 * y);
}

/// The 1 m relief of the accuracy scenes: smooth forms, V grooves 3 mm deep and 10 mm wide, a 10 mm step.
inline double relief_m(double x, double y) {
  double z = smooth_forms_m(x, y);
  const double ring = std::abs(std::hypot(x - 0.3, y - 0.4) - 0.18);
  const double line = std::abs((x - 0.2) * 0.6 - (y - 0.75) * 0.8);
  z -= 0.003 * std::max(0.0, 1.0 - std::min(ring, line) / 0.005);
  if (x > step_edge_m(y)) z += 0.010;
  return z;
}

struct ScanNoise {
  double sigma_m = 0.0002;
  double outliers = 0.0;         ///< share of the front points
  double outlier_span_m = 0.06;  ///< outliers lie up to this above or below the surface
};

/// `count` points on z = f over the box, uniform at random, with noise along z.
inline void sample_surface(Points& out, const HeightFunction& f, std::size_t count, const ScanNoise& noise,
                           std::mt19937_64& random, std::array<double, 4> box = {0.0, 0.0, 1.0, 1.0}) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = box[0] + (box[2] - box[0]) * unit(random);
    const double y = box[1] + (box[3] - box[1]) * unit(random);
    double z = f(x, y) + noise.sigma_m * normal(random);
    if (unit(random) < noise.outliers) z += noise.outlier_span_m * (2.0 * unit(random) - 1.0);
    out.push_back({x, y, z});
  }
}

/// The relief at 512 nodes with `front` and `back` points per node; the back is rough and 60 mm behind.
inline Points relief_scan(double front, double back, std::uint64_t seed, double sigma_m = 0.0002) {
  std::mt19937_64 random(seed);
  Points points;
  const double nodes = 512.0 * 512.0;
  points.reserve(static_cast<std::size_t>((front + back) * nodes * 1.01));
  sample_surface(points, relief_m, static_cast<std::size_t>(front * nodes), {sigma_m, 0.005}, random);
  const auto rough_back = [](double x, double y) { return -0.065 + 0.004 * std::sin(90.0 * x) * std::sin(70.0 * y); };
  sample_surface(points, rough_back, static_cast<std::size_t>(back * nodes), {0.001, 0.0}, random);
  return points;
}

}  // namespace sparsha::test
