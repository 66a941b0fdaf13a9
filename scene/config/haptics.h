// The configuration's `haptics` block, apart from the rest for programs that render touch without scenes.
#pragma once

#include "scene/material/materials.h"

namespace sparsha::scene {

struct HapticsConfig {
  enum class Solver { exact, paper };
  enum class Surface { bilinear, c1 };
  enum class Creases { sharp, rounded };
  enum class Beyond { continued, falls, rim };
  double stiffness_n_per_m = 800.0;
  Solver solver = Solver::exact;
  Surface surface = Surface::bilinear;
  Creases creases = Creases::rounded;  ///< of the bilinear surface; a c1 surface has none
  double rate_hz = 1000.0;
  double resolution_m = 0.00005;
  double tip_radius_m = 0.0005;   ///< of the ball that touches, device frame; 0: a point
  Beyond beyond = Beyond::falls;  ///< an outline, and holes wider than a finger finds (scene/ground/beyond.h)
  // Invented, not measured:
  bool impact = false;                    ///< a strike rings
  bool grain = false;                     ///< the texture's spectrum goes on above what the scan resolves
  Material material = Material::granite;  ///< of both, where a part has none of its own
};

/// As two flags of a state tell it.
[[nodiscard]] constexpr HapticsConfig::Beyond beyond_of(bool falls, bool after_rim) {
  if (!falls) return HapticsConfig::Beyond::continued;
  return after_rim ? HapticsConfig::Beyond::rim : HapticsConfig::Beyond::falls;
}

}  // namespace sparsha::scene
