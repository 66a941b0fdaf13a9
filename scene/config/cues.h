// The configuration's `cues` block: short sounds and ticks that say what the hand has come to, apart from the rest for
// programs that render touch without scenes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace sparsha::scene {

/// What a cue tells of.
enum class Cue : std::uint8_t { level, edge, unmeasured, part_entered, part_left };
inline constexpr std::size_t kCues = 5;
/// Keys of the block, in the order of Cue.
inline constexpr std::array<std::string_view, kCues> kCueNames{"level", "edge", "unmeasured", "part_entered",
                                                               "part_left"};

struct CuesConfig {
  std::array<bool, kCues> sound{true, true, true, true, true};
  std::array<bool, kCues> tick{true, true, true, true, true};
  bool lost = true;  ///< a tone leads back to the stone
};

}  // namespace sparsha::scene
