// Friction coefficients of a window's nodes from the scene's curvature layers.
#pragma once

#include <vector>

#include "pipeline/scene/scene.h"

namespace sparsha::haptics {

/// Coefficients per node, both 0 where nothing was measured or filled.
struct FrictionMap {
  std::vector<float> mu_dynamic;
  std::vector<float> mu_static;  ///< max(mu_static, mu_dynamic) at every node
};

/// law curvature: mu_d = clamp(mu_0 + c k, 0, mu_max), k in scene units, so that zoom does not change the stone.
/// law paper: mu_d = 1 / (R sqrt(H^2 + K^2)) clamped to [0, mu_max] (Aniyath et al., eq. 7 to 9), curvatures at the
/// window's scale, R = half the workspace's width, metres. law constant: mu_0. Where the curvature is not known,
/// near steps and holes, mu_d is mu_0. Empty when the scene has no friction block.
[[nodiscard]] FrictionMap evaluate_friction(const pipeline::SceneDescription& scene, const pipeline::Layers& window,
                                            double scale);

}  // namespace sparsha::haptics
