// How far forces are from the truth: the one place where the race and the judge of the open benchmark compute errors.
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace sparsha::protocol {

inline constexpr double kFeltError = 0.07;  // of the force: the least change that touch notices
inline constexpr double kGhost = 0.01;      // of the largest true force: a force in free space above this is one

struct Score {
  double error_median = 0.0;  ///< |F - T| / |T|; no force: 1
  double error_p99 = 0.0;
  double error_max = 0.0;
  double size_median = 0.0;  ///< | |F| / |T| - 1 |
  double size_p99 = 0.0;
  double angle_median_deg = 0.0;
  double angle_p99_deg = 0.0;
  double lost = 0.0;      ///< share of ticks without force, not finite, or off by as much as the force
  double felt = 0.0;      ///< share of ticks with an error above kFeltError
  double jumps = 0.0;     ///< share of ticks in which F - T changes by more than kFeltError of the force
  std::size_t worst = 0;  ///< tick of the largest error, from the beginning of the spans
};

/// `forces` against `truth` at ticks [first, last); the tick before `first` counts for jumps alone. Forces in any one
/// unit; those that are not finite count as the largest error. Requires equal sizes, first < last <= size and true
/// forces that are not zero in between.
[[nodiscard]] Score score_forces(std::span<const Eigen::Vector3d> forces, std::span<const Eigen::Vector3d> truth,
                                 std::size_t first, std::size_t last);

/// Share of the ticks outside [first, last) at which `forces` is off by more than kGhost of the largest true force
/// where there is no true force, by more than kFeltError of it where there is one; 0 when there are no such ticks.
[[nodiscard]] double ghost_share(std::span<const Eigen::Vector3d> forces, std::span<const Eigen::Vector3d> truth,
                                 std::size_t first, std::size_t last);

}  // namespace sparsha::protocol
