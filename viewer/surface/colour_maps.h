// Colour maps that stay readable with any colour vision: lightness rises steadily, hue runs from blue to yellow.
#pragma once

#include <array>
#include <cstdint>

namespace sparsha::viewer {

enum class ColourMap {
  sequential,  ///< dark blue to light yellow
  diverging    ///< blue, light grey, orange-brown: below, at and above zero
};

/// sRGB bytes for `t` in [0, 1] (clamped); NaN gives a neutral grey.
[[nodiscard]] std::array<std::uint8_t, 3> colour_of(ColourMap map, double t);

}  // namespace sparsha::viewer
