// Anchors are interpolated in the perceptual space OKLab (Ottosson 2020), so that equal steps look equal.
#include "viewer/surface/colour_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace sparsha::viewer {
namespace {

struct Lab {
  double lightness, a, b;
};

/// From lightness 0..1, chroma and hue in degrees.
constexpr double kDegree = 3.14159265358979323846 / 180.0;
Lab polar(double lightness, double chroma, double hue) {
  return {lightness, chroma * std::cos(hue * kDegree), chroma * std::sin(hue * kDegree)};
}

std::array<std::uint8_t, 3> to_srgb(const Lab& lab) {
  const double l = std::pow(lab.lightness + 0.3963377774 * lab.a + 0.2158037573 * lab.b, 3);
  const double m = std::pow(lab.lightness - 0.1055613458 * lab.a - 0.0638541728 * lab.b, 3);
  const double s = std::pow(lab.lightness - 0.0894841775 * lab.a - 1.2914855480 * lab.b, 3);
  const std::array<double, 3> linear{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                                     -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                                     -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  std::array<std::uint8_t, 3> result{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = std::clamp(linear[c], 0.0, 1.0);
    const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
    result[c] = static_cast<std::uint8_t>(std::lround(255.0 * encoded));
  }
  return result;
}

Lab interpolate(std::span<const Lab> anchors, double t) {
  const double x = std::clamp(t, 0.0, 1.0) * static_cast<double>(anchors.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(x), anchors.size() - 2);
  const double u = x - static_cast<double>(k);
  const Lab& p = anchors[k];
  const Lab& q = anchors[k + 1];
  return {p.lightness + u * (q.lightness - p.lightness), p.a + u * (q.a - p.a), p.b + u * (q.b - p.b)};
}

}  // namespace

std::array<std::uint8_t, 3> colour_of(ColourMap map, double t) {
  if (std::isnan(t)) return {122, 122, 122};
  static const std::array<Lab, 6> sequential{polar(0.26, 0.10, 272), polar(0.40, 0.11, 262), polar(0.53, 0.08, 240),
                                             polar(0.66, 0.06, 170), polar(0.80, 0.11, 108), polar(0.94, 0.14, 100)};
  static const std::array<Lab, 5> diverging{polar(0.38, 0.13, 258), polar(0.66, 0.10, 245), polar(0.93, 0.01, 90),
                                            polar(0.72, 0.12, 65), polar(0.46, 0.12, 45)};
  return to_srgb(map == ColourMap::sequential ? interpolate(sequential, t) : interpolate(diverging, t));
}

}  // namespace sparsha::viewer
