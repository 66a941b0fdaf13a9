// The heights of a window as a hand touches them: what the servo renders, the picture aims at and sound is made of.
#pragma once

#include <vector>

#include "scene/depth_grid.h"
#include "scene/ground/beyond.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// Which heights.
struct TouchedView {
  int level = 0;
  int i0 = 0;  ///< nodes of the level: [i0, i0 + nx) x [j0, j0 + ny); may reach beyond it
  int j0 = 0;
  int nx = 0;
  int ny = 0;
  double scale = 1.0;         ///< device metres per grid metre
  double tip_radius_m = 0.0;  ///< of the ball that touches, device frame; 0: a point
  bool texture = true;        ///< false: the envelope, where the scene has one
  HapticsConfig::Beyond beyond = HapticsConfig::Beyond::falls;
  bool operator==(const TouchedView&) const = default;
};

/// Nodes around a view that have to be read, so that what lies in it does not depend on where it ends.
[[nodiscard]] int margin_of(const SceneDescription& scene, const TouchedView& view);

/// How the view goes on beyond outlines.
[[nodiscard]] BeyondOptions beyond_of(const SceneDescription& scene, const TouchedView& view);

/// Gives `height_m` the heights of the layer that is touched, NaN where the mask says unknown, whatever the layer
/// holds.
void known_heights(const Layers& layers, bool texture, std::vector<float>& height_m);

struct TouchedHeights {
  Lattice lattice;              ///< of the view with its margin
  std::vector<float> height_m;  ///< per node, all known, row 0 at the bottom, relative to lattice.origin_m.z
  int margin = 0;               ///< nodes on every side that are not the view's
};

/// Reads a view. A ball's heights where it has a tip, lowered by the radius. Throws Error{input} when tiles cannot be
/// read, Error{failure} for an empty or absurd view.
[[nodiscard]] TouchedHeights read_touched(const Scene& scene, const TouchedView& view);

}  // namespace sparsha::scene
