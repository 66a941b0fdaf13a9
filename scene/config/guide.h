// The configuration's block `guide`.
#pragma once

#include <array>
#include <vector>

namespace sparsha::scene {

/// Along what, how strongly and how fast a hand is led that asks for it.
struct GuideConfig {
  enum class Path { outline, part, drawn };
  static constexpr std::array<const char*, 3> kPathNames{"outline", "part", "drawn"};
  static constexpr double kReachSpacings = 4.0;  ///< of a line in space from nodes of the surface that it is moved to
  Path path = Path::outline;                     ///< what is found in the heights; a part's border; `line_m`
  double force_n = 1.0;                          ///< the guide is never stronger
  double speed_m_per_s = 0.04;                   ///< at the hand
  std::vector<std::array<double, 2>> line_m;     ///< grid frame; closed where it ends in its first point
  std::vector<std::array<double, 3>> line_in_space_m;  ///< of whole objects, in its place: frame of the scans
};

}  // namespace sparsha::scene
