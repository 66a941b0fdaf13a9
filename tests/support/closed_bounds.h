// What is asked of the front of a closed object, by the number of its points, their noise and the grid: for tests and
// the benchmark.
#pragma once

#include <limits>
#include <string_view>

#include "tests/support/closed_scan.h"

namespace sparsha::test {

/// Shares (0 to 1) and mean point spacings; see Judgement.
struct ClosedBounds {
  double wrong_smooth = 0.0, beyond = 0.0;
  double wrong = std::numeric_limits<double>::infinity();
  double median_spacings = std::numeric_limits<double>::infinity();
  bool noise = false;  ///< the noise that is found lies within a quarter of the truth
};

/// Wrong everywhere as a method by tangent discs has shown to be possible at noise 0.1.
struct ReachedByDiscs {
  std::string_view object;
  std::size_t points;
  double wrong;
};
inline constexpr ReachedByDiscs kReached[] = {
    {"lionstatue.obj", 20'000, 0.016},       {"lionstatue.obj", 100'000, 0.011}, {"lionstatue.obj", 400'000, 0.009},
    {"nefertiti-lowres.obj", 20'000, 0.005}, {"bun_zipper.ply", 100'000, 0.006}, {"laurana.ply", 100'000, 0.005}};

/// Walls, thickness in mean point spacings at 20 000 points.
struct Wall {
  std::string_view object;
  double spacings;
};
inline constexpr Wall kWalls[] = {{"vase from the side", 3.25}, {"vase from above", 3.25}, {"coin", 4.25}};

/// Walls thinner than so many standard deviations of noise are taken for one sheet at a few nodes: discs through points
/// of both faces link the two. Seen of the vase's wall, 6.5 thick, on three samples and grids of 0.5, 1 and 2 spacings:
/// 0 to 0.0033 of the smooth nodes; of the coin, 8.5 thick: 0 to 0.0005. The report warns of such walls.
inline constexpr double kThinWallNoises = 7.0;

[[nodiscard]] constexpr bool has_thin_wall(std::string_view object, const ScanOptions& scan) {
  for (const Wall& wall : kWalls) {
    const double per_20000 = static_cast<double>(scan.points) / 20'000.0;
    const double noises = wall.spacings / scan.noise_spacings;
    // A spacing is inversely proportional to the root of the number of points.
    if (object == wall.object && noises * noises * per_20000 < kThinWallNoises * kThinWallNoises) return true;
  }
  return false;
}

[[nodiscard]] constexpr ClosedBounds closed_bounds(std::string_view object, const ScanOptions& scan) {
  const bool few = scan.points < 100'000;
  const bool noisy = scan.noise_spacings > 0.4;
  ClosedBounds b;
  b.wrong_smooth = few ? 0.003 : noisy ? 0.0015 : 0.0005;
  if (has_thin_wall(object, scan)) b.wrong_smooth = 0.005;
  b.beyond = few || noisy ? 0.015 : 0.005;
  // The lion misses 0.05 at 100 000 points: it has forms smaller than their spacing, which alone make 0.033. Seen are
  // 0.0503, 0.0510 and 0.0508 on grids of 1, 2 and 0.5 spacings.
  if (!few && scan.noise_spacings == 0.1)
    b.median_spacings = object == "lionstatue.obj" && scan.points < 400'000 ? 0.052 : 0.05;
  b.noise = !few && scan.noise_spacings >= 0.1;
  for (const ReachedByDiscs& reached : kReached) {
    const bool same = object == reached.object && scan.points == reached.points && scan.noise_spacings == 0.1;
    if (same) b.wrong = reached.wrong;
  }
  if (scan.density_ratio != 1.0 || scan.lines > 0.0) {
    b.wrong *= 2.0;
    b.wrong_smooth *= 2.0;
    b.beyond *= 2.0;
    b.median_spacings *= 2.0;
    if (scan.density_ratio != 1.0) b.noise = false;  // the mean spacing says nothing of the noise where density varies
  }
  return b;
}

}  // namespace sparsha::test
