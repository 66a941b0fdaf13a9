// The configuration's block `viewer`.
#pragma once

#include <array>

namespace sparsha::scene {

struct ViewerConfig {
  enum class Colour {
    relief,
    height,
    scan,
    friction,
    texture,
    slope,
    curvature,
    coverage,
    local_relief,
    sky_view,
    error
  };
  static constexpr std::array<const char*, 11> kColourNames{"relief",       "height",   "scan",      "friction",
                                                            "texture",      "slope",    "curvature", "coverage",
                                                            "local_relief", "sky_view", "error"};
  enum class Stereo { off, anaglyph, grey, side_by_side };
  static constexpr std::array<const char*, 4> kStereoNames{"off", "anaglyph", "grey", "side_by_side"};
  enum class Side { right, left };
  static constexpr std::array<const char*, 2> kSideNames{"right", "left"};
  Colour colour = Colour::relief;
  Stereo stereo = Stereo::off;
  Side overview = Side::right;  ///< where the overview lies, beside the selected region
};

}  // namespace sparsha::scene
