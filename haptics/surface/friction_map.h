// Friction coefficients of a window's nodes.
#pragma once

#include <vector>

#include "pipeline/scene/scene.h"

namespace sparsha::haptics {

/// Coefficients per node by the scene's FrictionLaw, both 0 where nothing was measured or filled.
struct FrictionMap {
  std::vector<float> mu_dynamic;
  std::vector<float> mu_static;  ///< not below mu_dynamic
};

/// Empty when the scene has no friction block. `scale`: device metres a grid metre; the window fills the workspace.
[[nodiscard]] FrictionMap evaluate_friction(const pipeline::SceneDescription& scene, const pipeline::Layers& window,
                                            double scale);

}  // namespace sparsha::haptics
