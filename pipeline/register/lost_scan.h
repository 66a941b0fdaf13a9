// Why a scan has no place among the others.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "base/error.h"
#include "pipeline/register/aligned_pair.h"

namespace sparsha::pipeline {

/// Points that two thinned scans must have in common for one to hold on the other.
inline constexpr std::size_t kLeastMatches = 100;

/// A scan that no alignment links to the first one, and the scan on which it came nearest to a place.
struct LostScan {
  const std::string& name;
  const std::string& other;
  const AlignedPair& pair;            ///< of the two
  std::optional<double> too_far_m{};  ///< how far the alignment moves it, where that is farther than allowed
  double reach_m = 0.0;               ///< distance within which points are in common
  double min_overlap = 0.0;           ///< the configuration's
  std::string hint{};                 ///< at the end of what was expected
};

/// Names the scan, what was found of it, and what would help.
[[nodiscard]] Error refusal_of(const LostScan& lost);

}  // namespace sparsha::pipeline
