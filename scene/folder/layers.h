// The optional layers of a scene: their files, where they are in memory, and what says that a scene has them.
#pragma once

#include <array>
#include <vector>

#include "scene/depth_grid.h"
#include "scene/scene.h"

namespace sparsha::scene {

/// One value per node; `name` as scene.yaml lists it, and of its file in a level's folder.
struct OptionalLayer {
  const char* name;
  bool SceneDescription::*present;
  std::vector<float> Layers::*values;
};
inline constexpr std::array<OptionalLayer, 5> kFloatLayers{{
    {"envelope", &SceneDescription::has_envelope, &Layers::envelope_m},
    {"curvature", &SceneDescription::has_curvature, &Layers::curvature_per_m},
    {"mean-curvature", &SceneDescription::has_paper_curvatures, &Layers::mean_curvature_per_m},
    {"gaussian-curvature", &SceneDescription::has_paper_curvatures, &Layers::gaussian_curvature_per_m2},
    {"intensity", &SceneDescription::has_intensity, &Layers::intensity},
}};

}  // namespace sparsha::scene
