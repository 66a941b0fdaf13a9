#include "bench/race/spline_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;

constexpr double kMargin_m = 0.1;  // beyond it no hand goes

/// Weights of the four coefficients about a place and their derivatives, by cells.
struct Basis {
  int first = 0;
  std::array<double, 4> value{}, slope{};
};

Basis basis(double u) {
  Basis b;
  const double cell = std::floor(u), t = u - cell;
  b.first = static_cast<int>(cell) - 1;
  const double s = 1.0 - t;
  b.value = {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0, (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
             t * t * t / 6.0};
  b.slope = {-0.5 * s * s, 1.5 * t * t - 2.0 * t, 0.5 + t - 1.5 * t * t, 0.5 * t * t};
  return b;
}

class Spline {
 public:
  Spline(std::vector<double> heights, int side) : heights_(std::move(heights)), side_(side) {}
  [[nodiscard]] double height(double x, double y) const {
    const Basis across = basis(x * (side_ - 1)), up = basis(y * (side_ - 1));
    return sum(across.value, across.first, up.value, up.first);
  }
  [[nodiscard]] Vector2d slope(double x, double y) const {
    const Basis across = basis(x * (side_ - 1)), up = basis(y * (side_ - 1));
    return (side_ - 1) * Vector2d(sum(across.slope, across.first, up.value, up.first),
                                  sum(across.value, across.first, up.slope, up.first));
  }

 private:
  [[nodiscard]] double sum(const std::array<double, 4>& across, int i0, const std::array<double, 4>& up, int j0) const {
    double total = 0.0;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        total += across[static_cast<std::size_t>(i)] * up[static_cast<std::size_t>(j)] * at(i0 + i, j0 + j);
    return total;
  }
  /// Beyond the border the nearest one.
  [[nodiscard]] double at(int i, int j) const {
    return heights_[static_cast<std::size_t>(std::clamp(j, 0, side_ - 1)) * static_cast<std::size_t>(side_) +
                    static_cast<std::size_t>(std::clamp(i, 0, side_ - 1))];
  }
  std::vector<double> heights_;
  int side_;
};

/// One pass of 1 2 1 both ways: a Gaussian of variance 1/2 cell squared.
std::vector<double> smoothed(const std::vector<double>& heights, int side) {
  const auto pass = [side](const std::vector<double>& from, bool rows) {
    std::vector<double> to(from.size());
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const auto at = [&](int step) {
          const int x = std::clamp(rows ? i + step : i, 0, side - 1), y = std::clamp(rows ? j : j + step, 0, side - 1);
          return from[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x)];
        };
        to[static_cast<std::size_t>(j) * static_cast<std::size_t>(side) + static_cast<std::size_t>(i)] =
            0.25 * at(-1) + 0.5 * at(0) + 0.25 * at(1);
      }
    return to;
  };
  return pass(pass(heights, true), false);
}

}  // namespace

protocol::Ground spline_ground(const std::string& name, std::vector<double> heights, int side, double depth_m) {
  protocol::Ground ground;
  ground.name = name;
  for (int passes = 1;; passes *= 2) {
    const auto spline = std::make_shared<const Spline>(heights, side);
    ground.height = [spline](double x, double y) { return spline->height(x, y); };
    ground.slope = [spline](double x, double y) { return spline->slope(x, y); };
    ground.most_depth_m = protocol::deepest_m(ground, kMargin_m);
    if (ground.most_depth_m >= depth_m || passes > 4096) return ground;
    for (int k = 0; k < passes; ++k) heights = smoothed(heights, side);
  }
}

}  // namespace sparsha::bench
