// CIELAB anchors chosen so that lightness runs steadily and hue leaves the red-green axis alone or goes along with
// lightness.
#include "pipeline/report/colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace sparsha::pipeline {
namespace {

/// Inverse of the CIELAB companding.
double lab_inverse(double t) { return t > 6.0 / 29 ? t * t * t : 3 * (6.0 / 29) * (6.0 / 29) * (t - 4.0 / 29); }

std::uint8_t srgb_encode(double linear) {
  const double clipped = std::clamp(linear, 0.0, 1.0);
  const double value = clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * std::pow(clipped, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * value));
}

const std::vector<Lab>& anchors(ColourMap map) {
  static const std::vector<Lab> relief = {{6, 2, 4}, {35, 5, 12}, {68, 5, 17}, {97, 0, 6}};
  static const std::vector<Lab> height = {{17, 14, -42}, {42, -4, -26}, {67, -8, 18}, {93, -4, 58}};
  static const std::vector<Lab> texture = {{27, 14, -52}, {60, -6, -34}, {96, 0, 2}, {64, 22, 44}, {33, 36, 38}};
  static const std::vector<Lab> friction = {{97, -1, 8}, {79, 10, 44}, {52, 36, 44}, {22, 26, 16}};
  static const std::vector<Lab> error = {{97, 0, 3}, {76, 8, -22}, {48, 30, -42}, {18, 22, -30}};
  switch (map) {
    case ColourMap::height:
      return height;
    case ColourMap::texture:
      return texture;
    case ColourMap::friction:
      return friction;
    case ColourMap::error:
      return error;
    case ColourMap::relief:
      break;
  }
  return relief;
}

}  // namespace

std::string css(const Rgb& colour) { return fmt::format("#{:02x}{:02x}{:02x}", colour.r, colour.g, colour.b); }

Rgb to_rgb(const Lab& colour) {
  const double y = (colour.lightness + 16) / 116;
  const double white_x = 0.95047, white_z = 1.08883;  // D65
  const double cx = white_x * lab_inverse(y + colour.a / 500), cy = lab_inverse(y),
               cz = white_z * lab_inverse(y - colour.b / 200);
  return {srgb_encode(3.2404542 * cx - 1.5371385 * cy - 0.4985314 * cz),
          srgb_encode(-0.9692660 * cx + 1.8760108 * cy + 0.0415560 * cz),
          srgb_encode(0.0556434 * cx - 0.2040259 * cy + 1.0572252 * cz)};
}

Rgb colour_at(ColourMap map, double t) {
  const std::vector<Lab>& stops = anchors(map);
  const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const double share = place - static_cast<double>(k);
  const Lab &from = stops[k], &to = stops[k + 1];
  return to_rgb(
      {std::lerp(from.lightness, to.lightness, share), std::lerp(from.a, to.a, share), std::lerp(from.b, to.b, share)});
}

Palette palette_of(ColourMap map) {
  Palette palette;
  for (std::size_t k = 1; k < 255; ++k) palette[k] = colour_at(map, static_cast<double>(k - 1) / 253);
  palette[0] = kHatchLight;
  palette[255] = kHatchDark;
  return palette;
}

}  // namespace sparsha::pipeline
