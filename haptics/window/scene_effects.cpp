#include "haptics/window/scene_effects.h"

#include <cmath>

#include <Eigen/LU>

#include "scene/config.h"
#include "scene/scene_spectrum.h"

namespace sparsha::haptics {
std::shared_ptr<const SurfaceEffects> make_effects(const pipeline::Scene& scene, const WindowPlan& plan,
                                                   const pipeline::DepthGrid& heights) {
  const pipeline::SceneDescription& description = scene.description();
  auto effects = std::make_shared<SurfaceEffects>();
  effects->impact = plan.impact;
  effects->grain = plan.grain;
  effects->material = description.config.haptics.material;
  for (const pipeline::PartConfig& part : description.config.parts)
    if (part.touch.stiffness_n_per_m || part.touch.material)
      effects->parts.push_back({part.box_m, part.touch.stiffness_n_per_m, part.touch.material});
  if (plan.cues) {
    effects->cues = description.config.cues.value_or(pipeline::CuesConfig{});
    for (const pipeline::PartConfig& part : description.config.parts) effects->part_boxes_m.push_back(part.box_m);
    if (effects->cues->lost) {
      effects->stone_m = distance_to_stone(heights);
      effects->stone_lattice = heights.lattice;
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
  effects->border_m = pipeline::kBorderM / effects->scale;
  if (plan.grain) effects->field = pipeline::GrainField(pipeline::measure_spectrum(scene));
  return effects;
}

}  // namespace sparsha::haptics
