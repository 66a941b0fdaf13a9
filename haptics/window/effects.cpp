#include "haptics/window/effects.h"

#include <cmath>

#include <Eigen/LU>

#include "scene/area/regions.h"
#include "scene/config/parts.h"
#include "scene/ground/continuation.h"
#include "scene/material/measured_spectrum.h"
#include "scene/scene.h"

namespace sparsha::haptics {
std::shared_ptr<const SurfaceEffects> make_effects(const scene::Scene& scene, const WindowPlan& plan,
                                                   const scene::DepthGrid& heights) {
  const scene::SceneDescription& description = scene.description();
  auto effects = std::make_shared<SurfaceEffects>();
  effects->impact = plan.impact;
  effects->grain = plan.grain;
  effects->material = description.config.haptics.material;
  const auto& parts = description.config.parts;
  for (std::size_t part = 0; part < parts.size(); ++part)
    if (const scene::PartTouch& touch = parts[part].touch; touch.stiffness_n_per_m || touch.material)
      effects->parts.push_back({scene::area_of(description, part), touch.stiffness_n_per_m, touch.material});
  if (plan.cues) {
    effects->cues = description.config.cues.value_or(scene::CuesConfig{});
    for (std::size_t part = 0; part < parts.size(); ++part)
      effects->part_areas.push_back(scene::area_of(description, part));
    if (effects->cues->lost) {
      effects->stone_m = distance_to_stone(heights);
      effects->stone_lattice = heights.lattice;
      effects->stone_height_m = heights.height_m;
      scene::continue_heights(effects->stone_height_m, heights.lattice.nx, heights.lattice.ny);
    }
  }
  if (!plan.impact && !plan.grain && !plan.cues && !effects->has_stiffness()) return nullptr;
  double enlarged = 1.0;  // a scene that was scanned again may be drawn at another size than its parts
  if (description.region_from_grid) {
    const Eigen::Matrix3d linear = description.region_from_grid->topLeftCorner<3, 3>();
    enlarged = std::cbrt(std::abs(linear.determinant()));
    effects->region_from_grid = linear / enlarged;
  }
  effects->scale = plan.scale / enlarged;
  effects->border_m = scene::kBorder_m / effects->scale;
  if (plan.grain) effects->field = scene::GrainField(scene::measure_spectrum(scene));
  return effects;
}

}  // namespace sparsha::haptics
