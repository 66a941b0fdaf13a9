// The configuration's `haptics` block, apart from the rest for programs that render touch without scenes.
#pragma once

namespace sparsha::pipeline {

struct HapticsConfig {
  enum class Solver { exact, paper };
  enum class Surface { bilinear, c1 };
  enum class Creases { sharp, rounded };
  double stiffness_n_per_m = 800.0;
  Solver solver = Solver::exact;
  Surface surface = Surface::bilinear;
  Creases creases = Creases::rounded;  ///< of the bilinear surface; a c1 surface has none
  double rate_hz = 1000.0;
  double resolution_m = 0.00005;
  double tip_radius_m = 0.0005;  ///< of the ball that touches, device frame; 0: a point
};

}  // namespace sparsha::pipeline
