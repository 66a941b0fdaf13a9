// The cases that break renderers: every case by every method, judged by the same four questions.
#pragma once

#include <string>
#include <vector>

#include "bench/peers/entrants.h"

namespace sparsha::bench {

struct HardResult {
  std::string hard_case;
  std::string method;
  std::string verdict;  ///< pass, or the faults found: lost, NaN, energy, step
  double lost = 0.0;    ///< share of the ticks in question without force
  int not_finite = 0;   ///< ticks
  double gained = 0.0;  ///< energy that the hand gained over a closed way, of the spring's largest
  double worst_step =
      0.0;  ///< largest change of force in a tick, of the largest force, where the hand moves slowly; else 0
};

[[nodiscard]] std::vector<HardResult> hard_cases(const std::vector<Entrant>& entrants);
/// What each case is, in a sentence, in the order of the table.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> hard_case_texts();

}  // namespace sparsha::bench
