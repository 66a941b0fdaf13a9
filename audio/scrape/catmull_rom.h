// A cubic through nodes (Catmull & Rom 1974).
#pragma once

#include <array>

namespace sparsha::audio {

/// Weights of four nodes at a share of the way from the second to the third.
[[nodiscard]] inline std::array<double, 4> catmull_rom(double t) noexcept {
  return {0.5 * t * (t * (2.0 - t) - 1.0), 0.5 * (t * t * (3.0 * t - 5.0) + 2.0), 0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
          0.5 * t * t * (t - 1.0)};
}

}  // namespace sparsha::audio
