// Gaussian splats in every file that has them: what they are, and which of them are no surface.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/scan/writer.h"

namespace sparsha::pipeline {

/// A splat's colour is the constant term of spherical harmonics (Kerbl et al. 2023); 0 to 1 and beyond.
[[nodiscard]] constexpr double colour_of_splat(double constant_term) {
  return 0.5 + 0.28209479177387814 * constant_term;
}

/// What is said of every file of them.
inline constexpr const char* kSplatNote =
    "Gaussian splats: their centres, with the colour that all views share; how colours change with the view is not "
    "read";

/// Says once that the points are splats.
void note_splats(RawScan& scan);

/// The longer of two axes; not a number where one of them is none.
[[nodiscard]] inline double longer_axis(double a, double b) { return std::isnan(a) || a > b ? a : b; }

/// Takes away what training leaves between cameras and surface: splats that hardly show, and those far longer than
/// others, which stand for sky and haze, and those whose opacity or axes are not numbers. Coordinates are left to the
/// writer.
class SplatSieve {
 public:
  static constexpr double kLeastOpacity = 0.1;  ///< of 1
  static constexpr double kMostMedians = 20.0;
  /// Splats that are to be looked at, evenly over the file.
  static constexpr std::uint64_t kSample = 20'000;

  /// `longest`: standard deviation along the longest axis, file units.
  void look_at(double opacity, double longest);
  /// Ends the look; the first keeps() is behind it.
  void decide();
  /// Counts.
  [[nodiscard]] bool keeps(double opacity, double longest) {
    ++seen_;
    if (std::isnan(opacity) || !std::isfinite(longest)) {
      ++not_numbers_;
      return false;
    }
    const bool faint = opacity < kLeastOpacity;
    const bool large = longest > most_;
    faint_ += faint ? 1 : 0;
    large_ += large && !faint ? 1 : 0;
    return !faint && !large;
  }
  /// Says what the points are, and what was left out.
  void warn(RawScan& scan) const;

 private:
  std::vector<double> axes_;
  double most_ = 0.0;
  std::uint64_t faint_ = 0, large_ = 0, not_numbers_ = 0, seen_ = 0;
};

}  // namespace sparsha::pipeline
