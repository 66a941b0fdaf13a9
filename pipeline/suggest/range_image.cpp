#include "pipeline/suggest/range_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

using Steps = std::vector<Eigen::Vector2d>;

/// From each point to the next one, in pixels (perspective) or in x and y.
Steps steps_of(const PointRuns& runs, bool perspective) {
  Steps steps;
  const auto place = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
    return perspective ? Eigen::Vector2d(p.head<2>() / p.z()) : Eigen::Vector2d(p.head<2>());
  };
  for (const std::vector<Eigen::Vector3d>& run : runs.runs()) {
    for (std::size_t i = 0; i + 1 < run.size(); ++i) steps.emplace_back(place(run[i + 1]) - place(run[i]));
  }
  return steps;
}

/// Share of the steps that go by a few whole pixels along a row or column and stay on it, whichever fits more.
double share_on_raster(const Steps& steps) {
  constexpr double kMostPixels = 8.5;
  constexpr double kTolerance = 0.12;  // pixels
  double best = 0.0;
  for (const int along : {0, 1}) {
    std::vector<double> lengths;
    for (const Eigen::Vector2d& step : steps) {
      if (std::abs(step[along]) > std::abs(step[1 - along])) lengths.push_back(std::abs(step[along]));
    }
    if (2 * lengths.size() < steps.size()) continue;
    const double pixel = value_of_rank(lengths, lengths.size() / 2);
    if (!(pixel > 0.0)) continue;
    const auto fits = [&](const Eigen::Vector2d& step) {
      const double pixels = std::abs(step[along]) / pixel;
      return pixels > 0.5 && pixels < kMostPixels && std::abs(pixels - std::round(pixels)) < kTolerance &&
             std::abs(step[1 - along]) < kTolerance * pixel;
    };
    const auto count = std::count_if(steps.begin(), steps.end(), fits);
    best = std::max(best, static_cast<double>(count) / static_cast<double>(steps.size()));
  }
  return best;
}

/// How many places the values take that differ by more than rounding.
std::size_t places_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  constexpr double kRounding =
      2e-5;  // of the range: float32, after a division; an image has at most some 10 000 pixels
  const double same = kRounding * (values.back() - values.front());
  std::size_t places = 1;
  for (std::size_t i = 1; i < values.size(); ++i) places += values[i] - values[i - 1] > same ? 1 : 0;
  return places;
}

/// In whatever order: x / z and y / z take the places of few columns and rows, and x and y do not.
bool are_on_pixels(const std::vector<Eigen::Vector3d>& points) {
  constexpr std::size_t kManyEach = 4;  // points a column or row
  constexpr std::size_t kMoreAcross = 4;
  std::size_t pixels = 0;
  std::size_t lattice = 0;
  for (const int axis : {0, 1}) {
    std::vector<double> rays;
    std::vector<double> places;
    for (const Eigen::Vector3d& p : points) {
      rays.push_back(p[axis] / p.z());
      places.push_back(p[axis]);
    }
    const std::size_t taken = places_of(std::move(rays));
    if (taken < kManyEach || kManyEach * taken > points.size()) return false;
    pixels += taken;
    lattice += places_of(std::move(places));
  }
  return lattice > kMoreAcross * pixels;
}

}  // namespace

bool is_range_image(const RawScan& scan, const PointRuns& runs) {
  constexpr std::size_t kFewest = 200;
  constexpr double kMost = 0.8, kClearly = 0.2;
  constexpr double kTimes = 5.0, kMargin = 0.05;  // of a room, most points may lie on a wall across the view
  if (scan.points.size() < kFewest || is_z_up(scan.format)) return false;
  const auto before = [](const std::vector<Eigen::Vector3d>& points) {
    return std::all_of(points.begin(), points.end(), [](const auto& p) { return p.z() > 0.0; });
  };
  if (!before(scan.points) || !std::all_of(runs.runs().begin(), runs.runs().end(), before)) return false;
  const double share = share_on_raster(steps_of(runs, true));
  const double flat = share_on_raster(steps_of(runs, false));
  if (share > kMost && (share > flat + kClearly || 1.0 - flat > kTimes * (1.0 - share) + kMargin)) return true;
  return are_on_pixels(scan.points);
}

}  // namespace sparsha::pipeline
