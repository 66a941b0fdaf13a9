// A scene's stiffness, friction and fine relief as pictures, for the glTF extension MPEG_haptic_material.
#pragma once

#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// A picture of one quantity over level 0: a pixel a node, file row 0 is the top row; grey 0 is `least` and 255 `most`.
struct HapticMap {
  std::string property;     ///< of the extension: "stiffness", "friction", "vibrotactileTexture"
  std::string coefficient;  ///< what it is, for people and programs
  std::string unit;
  double least = 0.0, most = 1.0;
  std::string png;
};

/// Those that the scene has: stiffness always, the two coefficients of friction with a friction block, the relief over
/// the envelope with a texture. Unknown nodes have the value of the scene as a whole, the relief's is 0.
[[nodiscard]] std::vector<HapticMap> haptic_maps(const scene::Scene& scene, Progress& progress);

}  // namespace sparsha::pipeline
