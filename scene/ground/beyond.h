// The surface beyond what was measured: small holes stay closed, beyond an outline it falls away.
#pragma once

#include <vector>

#include "scene/config/haptics.h"

namespace sparsha::scene {

struct BeyondOptions {
  double spacing_m = 0.0;  ///< of the nodes, grid frame
  double scale = 1.0;      ///< device metres per grid metre
  double hole_m = 0.0;     ///< grid frame; what is narrower is a hole, and never less than kHoleNodes spacings
  HapticsConfig::Beyond kind = HapticsConfig::Beyond::falls;
};

inline constexpr double kHoleNodes = 3.0;       ///< spacings
inline constexpr double kHoleAtHand_m = 0.003;  ///< device frame; a hole that no finger falls into stays closed
inline constexpr double kEdgeRadius_m = 0.003;  ///< device frame; of the rounding of a level edge
inline constexpr double kFallSlope = 2.0;       ///< of what falls away; a steeper edge goes on as steeply
inline constexpr double kFall_m = 0.015;  ///< device frame; so far below the lowest edge the surface is level again
inline constexpr double kRim_m = 0.0006;  ///< device frame; height of a felt rim
inline constexpr double kRimWidth_m = 0.0024;  ///< device frame

/// Nodes that a hole at a window's border reaches beyond it; 0 where heights are continued everywhere.
[[nodiscard]] int hole_margin(const BeyondOptions& options);
/// Nodes from an edge to where the surface is level again; 0 likewise.
[[nodiscard]] int fall_nodes(const BeyondOptions& options);

/// Gives nodes that are NaN a height: those of holes what continue_heights() gives them, the others that of the nearest
/// edge less a rounded fall. Beyond::falls rises nowhere away from the edge, Beyond::rim first by kRim_m where the edge
/// is level, Beyond::continued is continue_heights() everywhere. Known nodes stay as they are. `height_m`: nx * ny, row
/// by row; everything unknown gives 0.
void continue_beyond(std::vector<float>& height_m, int nx, int ny, const BeyondOptions& options);

}  // namespace sparsha::scene
