// The colours of pictures grow steadily in lightness and stay apart for people who see two colours.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "pipeline/report/colour.h"
#include "pipeline/report/style.h"
#include "tests/pipeline/report/contrast.h"

namespace sparsha::pipeline {
namespace {

using testing::contrast;
using testing::luminance;

TEST(ReportColours, GrowSteadilyInLightness) {
  for (const ColourMap map : {ColourMap::relief, ColourMap::height, ColourMap::friction, ColourMap::error}) {
    const bool rising = luminance(colour_at(map, 1)) > luminance(colour_at(map, 0));
    for (int k = 1; k <= 64; ++k) {
      const double before = luminance(colour_at(map, (k - 1) / 64.0)), here = luminance(colour_at(map, k / 64.0));
      EXPECT_EQ(here > before, rising) << static_cast<int>(map) << ' ' << k;
    }
    EXPECT_GT(contrast(colour_at(map, 0), colour_at(map, 1)), 7);
  }
  // The diverging map is lightest in the middle.
  for (int k = 1; k <= 32; ++k) {
    EXPECT_GT(luminance(colour_at(ColourMap::texture, k / 64.0)),
              luminance(colour_at(ColourMap::texture, (k - 1) / 64.0)));
    EXPECT_GT(luminance(colour_at(ColourMap::texture, 1 - k / 64.0)),
              luminance(colour_at(ColourMap::texture, 1 - (k - 1) / 64.0)));
  }
}

/// What a dichromat sees (Vienot, Brettel & Mollon 1999), linear RGB.
std::array<double, 3> dichromat(const Rgb& c, bool deutan) {
  const auto channel = [](std::uint8_t v) {
    const double s = v / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  const double r = channel(c.r), g = channel(c.g), b = channel(c.b);
  if (deutan) return {0.29275 * r + 0.70725 * g, 0.29275 * r + 0.70725 * g, -0.02234 * r + 0.02234 * g + b};
  return {0.11238 * r + 0.88762 * g, 0.11238 * r + 0.88762 * g, 0.00401 * r - 0.00401 * g + b};
}

TEST(ReportColours, StayApartForDichromats) {
  for (const bool deutan : {false, true}) {
    for (const ColourMap map : {ColourMap::height, ColourMap::texture, ColourMap::friction, ColourMap::error})
      for (int a = 0; a <= 8; ++a)
        for (int b = a + 1; b <= 8; ++b) {
          const auto x = dichromat(colour_at(map, a / 8.0), deutan), y = dichromat(colour_at(map, b / 8.0), deutan);
          double apart = 0;
          for (std::size_t k = 0; k < 3; ++k) apart = std::max(apart, std::abs(std::cbrt(x[k]) - std::cbrt(y[k])));
          EXPECT_GT(apart, 0.03) << "map " << static_cast<int>(map) << " colours " << a << ' ' << b;
        }
  }
  EXPECT_GT(contrast(kMeasuredColour, kFilledColour), 3);
  EXPECT_GT(contrast(kMeasuredColour, kHatchDark), 3);
}

}  // namespace
}  // namespace sparsha::pipeline
