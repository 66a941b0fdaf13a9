// Which nodes of which level a haptic window is, and making its surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "haptics/servo/command.h"
#include "scene/frame/touched_view.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// Nodes [i0, i0+nx) x [j0, j0+ny) of a level; may reach beyond it.
struct WindowPlan {
  int level = 0;
  int i0 = 0, j0 = 0, nx = 0, ny = 0;
  int nodes = 0;       ///< per side that the zoom step asks for; the level may have fewer
  double scale = 1.0;  ///< device metres per grid metre
  Effects effects;
  double tip_radius_m = 0.0;  ///< of the ball that touches, device frame; 0: a point
  bool impact = false;        ///< invented: strikes ring
  bool cues = false;          ///< ticks tell what the hand has come to
  bool around = false;        ///< the whole object is touched
  bool grain = false;         ///< invented: the texture goes on above what the scan resolves
  scene::HapticsConfig::Beyond beyond = scene::HapticsConfig::Beyond::continued;  ///< outlines
};

/// The heights that the plan is touched on.
[[nodiscard]] scene::TouchedView view_of(const WindowPlan& plan);

/// Is the scene a whole object that touch goes around? It takes the exact proxy.
[[nodiscard]] bool touches_all_around(const scene::SceneDescription& scene);

/// The finest level that fits whole into a window of the configured size; the coarsest that has a cell when none does.
[[nodiscard]] int overview_level(const scene::SceneDescription& scene);

/// How much of the scene lies under the hand: so many nodes per side of a level.
struct ZoomStep {
  int level = 0;
  int nodes = 0;
};

/// From the whole scene to the nearest view: `levels.window` nodes of every level from overview_level() to level 0,
/// then ever fewer nodes of level 0, each step twice as near at a whole power of two (1:1, 2:1, ...), to 8 times the
/// stone's size or to nodes 4 mm apart under the hand, whichever comes first.
[[nodiscard]] std::vector<ZoomStep> zoom_steps(const scene::SceneDescription& scene, double workspace_width_m);

/// The window of a step around a point (grid frame): the whole level when it fits (its own lattice, so that `trace` on
/// the level is the same computation), else the step's nodes per side. Scale = workspace width / window width. Where
/// the level ends within the window and is an outline, the window reaches beyond it until the surface is level again.
/// The fingertip, impact, grain and what lies beyond outlines are the configuration's; a fingertip is for one view
/// alone: a whole object is touched with a point.
[[nodiscard]] WindowPlan plan_window(const scene::SceneDescription& scene, const ZoomStep& step,
                                     const Eigen::Vector2d& centre_m, double workspace_width_m);
/// The same with levels.window nodes per side.
[[nodiscard]] WindowPlan plan_window(const scene::SceneDescription& scene, int level, const Eigen::Vector2d& centre_m,
                                     double workspace_width_m);

/// The middle of a level, grid frame.
[[nodiscard]] Eigen::Vector2d middle_of(const scene::Lattice& lattice);

/// Reads the tiles that are needed and makes the surface; centre at the nodes' middle, z of the surface there.
/// Throws Error{input} when tiles cannot be read.
[[nodiscard]] HapticWindow load_window(const scene::Scene& scene, const WindowPlan& plan, std::uint64_t id,
                                       const Progress* progress = nullptr);

}  // namespace sparsha::haptics
