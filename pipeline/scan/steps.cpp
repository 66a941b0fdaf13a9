// A step is the greatest common divisor of the differences between sampled coordinates. Whether the points are rounded
// to it, or measured on a raster of it, is told about some places: rounding puts several points to one place by chance,
// a raster puts one to each.
#include "pipeline/scan/steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "base/numbers/statistics.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/surroundings.h"

namespace sparsha::pipeline {
namespace {

constexpr double kCoarse = 0.1;       // of the points' distance
constexpr double kSuspicious = 0.02;  // the same, by the guess from the extent
constexpr std::size_t kPlaces = 256;
constexpr double kReach = 4.0;  // point distances, or steps, about a place
constexpr std::size_t kFewest = 16;

struct Axis {
  std::vector<double> levels;  ///< of the sample, ascending, each once; far outliers left out
  double step = 0.0;
  double single = 0.0;  ///< step of float32 at the largest magnitude, when all levels are float32
};

double largest_magnitude(const std::vector<double>& ascending) {
  return std::max(std::abs(ascending.front()), std::abs(ascending.back()));
}

double float_step(double magnitude) {
  const auto value = static_cast<float>(magnitude);
  return static_cast<double>(std::nextafter(value, std::numeric_limits<float>::infinity())) -
         static_cast<double>(value);
}

/// Greatest common divisor of the differences, but for `rounding`; 0 when it is below `least`.
double common_step(const std::vector<double>& levels, double least, double rounding) {
  if (levels.size() < 2 || rounding > 0.05 * least) return 0.0;
  double step = 0.0;
  for (std::size_t n = 1; n < levels.size(); ++n) {
    double a = step;
    double b = levels[n] - levels[n - 1];
    while (b > rounding) {
      const double rest = std::abs(std::remainder(a, b));
      a = b;
      b = rest;
    }
    step = a;
    if (step < least) return 0.0;
  }
  return step;
}

Axis axis_of(const std::vector<Eigen::Vector3d>& sample, int axis, double least) {
  const double low = coordinate_quantile(sample, axis, 0.01);
  const double high = coordinate_quantile(sample, axis, 0.99);
  Axis result;
  for (const Eigen::Vector3d& p : sample) {
    if (p[axis] >= low - (high - low) && p[axis] <= high + (high - low)) result.levels.push_back(p[axis]);
  }
  std::sort(result.levels.begin(), result.levels.end());
  result.levels.erase(std::unique(result.levels.begin(), result.levels.end()), result.levels.end());
  if (result.levels.empty()) return result;
  const bool all_single = std::all_of(result.levels.begin(), result.levels.end(), [](double v) {
    return std::abs(v) < 1e37 && static_cast<double>(static_cast<float>(v)) == v;
  });
  const double largest = largest_magnitude(result.levels);
  if (all_single) result.single = float_step(largest);
  result.step = common_step(result.levels, least, 4.0 * std::numeric_limits<double>::epsilon() * largest);
  // Decimals that were stored as float32.
  if (!(result.step > 0.0) && all_single) result.step = common_step(result.levels, least, 2.0 * result.single);
  return result;
}

constexpr std::array<std::array<int, 2>, 3> kPairs = {{{0, 1}, {1, 2}, {2, 0}}};

/// The largest multiple of an axis' step in which nearly all neighbours are from each other: scans of several rasters
/// have their own everywhere, though together they share a finer one.
double local_step(const Surroundings& around, int axis, double step) {
  constexpr double kMost = 0.9;
  constexpr int kLargest = 20;
  if (!(step > 0.0)) return 0.0;
  std::array<std::uint64_t, kLargest + 1> multiples{};
  std::uint64_t all = 0;
  around.each([&](const std::vector<Eigen::Vector3d>& away) {
    for (const Eigen::Vector3d& v : away) {
      const std::int64_t steps = std::llround(v[axis] / step);
      if (steps == 0) continue;
      ++all;
      for (int times = 2; times <= kLargest; ++times)
        multiples[static_cast<std::size_t>(times)] += steps % times == 0 ? 1 : 0;
    }
  });
  int best = 1;
  for (int times = 2; times <= kLargest; ++times) {
    if (all > 0 && static_cast<double>(multiples[static_cast<std::size_t>(times)]) >= kMost * static_cast<double>(all))
      best = times;
  }
  return best * step;
}

/// Whether the points take places of a lattice in these two coordinates one by one.
bool is_raster(const Surroundings& around, const std::array<int, 2>& pair, const std::array<double, 3>& step) {
  constexpr double kFilled = 0.25;  // of the places beside one
  constexpr double kUneven = 0.1;   // variance over mean of the points at a place; of chance it is near 1
  const auto [a, b] = pair;
  const double across = step[static_cast<std::size_t>(a)];
  const double along = step[static_cast<std::size_t>(b)];
  if (!(across > 0.0 && along > 0.0)) return false;
  double places = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  double filled = 0.0;
  around.each([&, a = a, b = b](const std::vector<Eigen::Vector3d>& away) {
    std::array<bool, 4> beside{};
    double together = 0.0;
    for (const Eigen::Vector3d& v : away) {
      const double u = v[a] / across;
      const double w = v[b] / along;
      const auto is = [](double value, double whole) { return std::abs(value - whole) < 0.25; };
      if (is(u, 0) && is(w, 0)) together += 1.0;
      beside[0] = beside[0] || (is(u, 1) && is(w, 0));
      beside[1] = beside[1] || (is(u, -1) && is(w, 0));
      beside[2] = beside[2] || (is(u, 0) && is(w, 1));
      beside[3] = beside[3] || (is(u, 0) && is(w, -1));
    }
    places += 1.0;
    sum += together;
    squares += together * together;
    filled += 0.25 * static_cast<double>(std::count(beside.begin(), beside.end(), true));
  });
  if (!(places > 0.0)) return false;
  const double mean = sum / places;
  return filled >= kFilled * places && squares / places - mean * mean <= kUneven * mean;
}

/// Whether an axis points across the surface at most places, so that its coordinate is a height.
bool is_height(const Surroundings& around, int axis) {
  constexpr double kAcross = 0.7;
  constexpr std::size_t kFewestPoints = 6;
  std::vector<double> across;
  around.each([&](const std::vector<Eigen::Vector3d>& away) {
    if (away.size() < kFewestPoints) return;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& v : away) mean += v;
    mean /= static_cast<double>(away.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& v : away) covariance += (v - mean) * (v - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
    across.push_back(std::abs(axes.eigenvectors()(axis, 0)));
  });
  return !across.empty() && median(across) > kAcross;
}

/// Whether few levels are those of rounded heights: about most places other levels are near, a step or two away, as
/// they are neither on a plate nor on the treads of stairs and terraces.
bool are_rounded_heights(const Surroundings& around, int axis, const Axis& heights, double step, double apart) {
  constexpr std::size_t kFewestLevels = 4;  // a plate with its noise has three
  constexpr double kHighest = 2.0;          // point distances; the risers of stairs are higher
  constexpr double kNear = 2.5;             // the same
  constexpr double kMost = 0.5;
  if (heights.levels.size() < kFewestLevels || step > kHighest * apart) return false;
  double places = 0.0;
  double between = 0.0;
  around.each([&](const std::vector<Eigen::Vector3d>& away) {
    places += 1.0;
    const bool other = std::any_of(away.begin(), away.end(), [&](const Eigen::Vector3d& v) {
      Eigen::Vector3d across = v;
      across[axis] = 0.0;
      return std::abs(v[axis]) > 0.5 * step && across.norm() <= kNear * apart;
    });
    between += other ? 1.0 : 0.0;
  });
  return places > 0.0 && between >= kMost * places;
}

/// Some of the sample's places, each once: a function of its set.
std::vector<Eigen::Vector3d> some_places(std::vector<Eigen::Vector3d> sample) {
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(sample.begin(), sample.end(), less);
  sample.erase(std::unique(sample.begin(), sample.end()), sample.end());
  std::vector<Eigen::Vector3d> places;
  const std::size_t every = std::max<std::size_t>(1, sample.size() / kPlaces);
  for (std::size_t n = 0; n < sample.size(); n += every) places.push_back(sample[n]);
  return places;
}

}  // namespace

std::optional<CoarseSteps> coarse_steps(std::vector<Eigen::Vector3d> sample, std::uint64_t points, bool mesh,
                                        const EachPoint& each) {
  if (sample.size() < kFewest) return std::nullopt;
  const double guess = distance_by_extent(sample, points);
  if (!(guess > 0.0)) return std::nullopt;
  const double least = kSuspicious * guess;
  std::array<Axis, 3> axes;
  std::array<double, 3> step{};
  bool suspicious = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes[axis] = axis_of(sample, static_cast<int>(axis), least);
    step[axis] = axes[axis].step;
    suspicious = suspicious || step[axis] > 0.0;
  }
  if (!suspicious) return std::nullopt;

  const double widest = *std::max_element(step.begin(), step.end());
  Surroundings around(some_places(std::move(sample)), kReach * std::max(guess, std::min(widest, 2.0 * guess)));
  each([&](std::span<const Eigen::Vector3d> block) {
    for (const Eigen::Vector3d& p : block) around.add(p);
  });
  CoarseSteps found;
  // Where steps are wider than the points are apart, points stand in heaps.
  found.apart = widest > 2.0 * guess ? guess : around.apart();
  const double limit = kCoarse * found.apart;

  std::array<double, 3> local{};
  for (std::size_t axis = 0; axis < 3; ++axis) local[axis] = local_step(around, static_cast<int>(axis), step[axis]);
  std::array<bool, 3> raster{};
  for (const std::array<int, 2>& pair : kPairs) {
    if (!is_raster(around, pair, local)) continue;
    for (const int axis : pair) raster[static_cast<std::size_t>(axis)] = true;
  }

  // Steps of float32, in a file whose numbers all are. One power of two to spare: the largest number may be the only
  // one beyond it.
  found.single = std::all_of(axes.begin(), axes.end(), [](const Axis& axis) { return axis.single > 0.0; });
  for (std::size_t axis = 0; found.single && axis < 3; ++axis) {
    const bool coarse = step[axis] > limit && step[axis] <= 2.0 * axes[axis].single;
    if (coarse && !raster[axis]) found.step[axis] = step[axis];
  }
  if (found.any()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // All points have one value: what their numbers can tell is their step.
      if (axes[axis].levels.size() == 1 && axes[axis].single > limit) found.step[axis] = axes[axis].single;
    }
    return found;
  }

  found.single = false;
  const bool on_raster = raster[0] || raster[1] || raster[2];
  // The vertices of a small mesh, or of one on a lattice, are anybody's design.
  constexpr std::uint64_t kMeasuredMesh = 10'000;
  if (mesh && (on_raster || points < kMeasuredMesh)) return std::nullopt;
  std::size_t coarse = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (raster[axis] || !(step[axis] > limit)) continue;
    found.step[axis] = step[axis];
    ++coarse;
  }
  // One coordinate alone: lines of a scanner have steps along the surface; heights have many levels, or few that change
  // from point to point.
  if (coarse == 1) {
    const auto axis =
        static_cast<std::size_t>(std::max_element(found.step.begin(), found.step.end()) - found.step.begin());
    if (!is_height(around, static_cast<int>(axis))) return std::nullopt;
    if (axes[axis].levels.size() < kFewest &&
        !are_rounded_heights(around, static_cast<int>(axis), axes[axis], step[axis], found.apart)) {
      return std::nullopt;
    }
  }
  return coarse >= (mesh ? 3U : 1U) ? std::optional(found) : std::nullopt;
}

}  // namespace sparsha::pipeline
