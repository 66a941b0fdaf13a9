// Random moves of the hand on random surfaces, every rest judged by the oracle.
#pragma once

#include <cstdint>

namespace sparsha::haptics::test {

struct SoakCount {
  std::uint64_t moves = 0;
  std::uint64_t contacts = 0;
  std::uint64_t non_stationary = 0;
  std::uint64_t below = 0;
  std::uint64_t not_a_number = 0;
  std::uint64_t stuck = 0;       ///< free but not at the hand, or pulled by the surface
  std::uint64_t rose = 0;        ///< the distance to the hand grew
  std::uint64_t tunnelled = 0;   ///< through a ridge that was too high to climb
  std::uint64_t unfinished = 0;  ///< ticks that used up their segments; not an error
  std::uint64_t most_segments = 0;
  double worst_excess_cells = 0.0;
  double worst_below_cells = 0.0;
};

[[nodiscard]] inline std::uint64_t failures(const SoakCount& count) {
  return count.non_stationary + count.below + count.not_a_number + count.stuck + count.rose + count.tunnelled;
}

/// `moves` moves, reproducible from the seed; thread-safe. Failures are described on standard error, at most ten.
[[nodiscard]] SoakCount run_soak(std::uint64_t moves, std::uint64_t seed);

}  // namespace sparsha::haptics::test
