// The surface of a window of a scene.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "haptics/servo/command.h"
#include "haptics/surface/monge_surface.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

struct SurfaceOptions {
  Effects effects;
  std::uint64_t id = 0;       ///< becomes MongeSurface::id
  double tip_radius_m = 0.0;  ///< of the ball that touches, device frame; 0: a point
  int margin = 0;             ///< the layers reach so many nodes beyond the window on every side
  scene::HapticsConfig::Beyond beyond = scene::HapticsConfig::Beyond::continued;
  std::optional<Eigen::Vector3d> centre_m;                ///< grid frame; absent: the surface in the window's middle
  std::shared_ptr<const SurfaceEffects> surface_effects;  ///< may be null
  const Progress* progress = nullptr;                     ///< may cancel; null: nobody does
};

/// Coefficients per node by the scene's FrictionLaw, both 0 where nothing was measured or filled. Empty when the scene
/// has no friction block. `scale`: device metres per grid metre; the window fills the workspace.
[[nodiscard]] FrictionMap evaluate_friction(const scene::SceneDescription& scene, const scene::Layers& window,
                                            int level, double scale);

/// Builds the surface from a window's layers: friction by the scene's law, evaluated here at the window's scale (device
/// metres per grid metre). Off the servo thread. Throws Error{failure} when layers and lattice do not match.
[[nodiscard]] std::shared_ptr<const MongeSurface> make_surface(const scene::SceneDescription& scene,
                                                               const scene::Layers& window, int level, double scale,
                                                               const SurfaceOptions& options);

}  // namespace sparsha::haptics
