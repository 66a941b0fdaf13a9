// How light and form are shown.
#pragma once

#include <array>
#include <cstddef>

namespace sparsha::viewer {

enum class Look {
  stone,    ///< a raking light over the sky's
  sky,      ///< the sky's light alone: ambient occlusion
  clay,     ///< a matcap: brightness by the direction that the surface faces in the picture
  eye_dome  ///< even light, and what lies deeper than its surroundings is dark
};
inline constexpr int kLooks = 4;

[[nodiscard]] inline const char* name_of(Look look) {
  constexpr std::array<const char*, kLooks> kNames{"stone", "sky light", "clay", "edges of depth"};
  return kNames[static_cast<std::size_t>(look)];
}

}  // namespace sparsha::viewer
