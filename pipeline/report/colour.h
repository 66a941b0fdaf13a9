// Colour maps of the report: monotone in lightness, so that they read alike in grey and with any colour vision.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace sparsha::pipeline {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};

/// "#rrggbb".
[[nodiscard]] std::string css(const Rgb& colour);

/// A colour in CIELAB (D65): lightness 0 to 100, a towards red, b towards yellow.
struct Lab {
  double lightness, a, b;
};
/// The nearest sRGB colour, clipped to the gamut.
[[nodiscard]] Rgb to_rgb(const Lab& colour);

enum class ColourMap { relief, height, texture, friction, error };

/// Colour at `t` of 0 to 1, linear in CIELAB between the map's anchors.
[[nodiscard]] Rgb colour_at(ColourMap map, double t);

/// Fixed colours.
inline constexpr Rgb kMeasuredColour{0x1F, 0x5F, 0x99};
inline constexpr Rgb kFilledColour{0xE8, 0xA3, 0x1A};
inline constexpr Rgb kHatchLight{0xE4, 0xE5, 0xE8};  ///< unknown nodes: diagonal stripes of two greys
inline constexpr Rgb kHatchDark{0xC3, 0xC6, 0xCC};

/// Pixel values 0 and 255 are the hatch; 1 to 254 run through the map.
using Palette = std::array<Rgb, 256>;
[[nodiscard]] Palette palette_of(ColourMap map);

}  // namespace sparsha::pipeline
