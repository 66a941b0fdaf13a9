#include "haptics/effects/surface_effects.h"

#include <algorithm>

namespace sparsha::haptics {

bool SurfaceEffects::has_stiffness() const noexcept {
  return std::any_of(parts.begin(), parts.end(), [](const Part& part) { return part.stiffness_n_per_m.has_value(); });
}

double SurfaceEffects::stiffness_at(double x_m, double y_m, double base_n_per_m) const noexcept {
  double stiffness = base_n_per_m;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part)
    if (part->stiffness_n_per_m)
      stiffness += (*part->stiffness_n_per_m - stiffness) * pipeline::share_inside(part->box_m, x_m, y_m, border_m);
  return stiffness;
}

const pipeline::MaterialTouch& SurfaceEffects::material_at(double x_m, double y_m) const noexcept {
  for (const Part& part : parts)
    if (part.material && pipeline::share_inside(part.box_m, x_m, y_m, border_m) >= 0.5)
      return pipeline::touch_of(*part.material);
  return pipeline::touch_of(material);
}

double SurfaceEffects::grain_gain_at(double x_m, double y_m) const noexcept {
  double gain = pipeline::touch_of(material).grain_gain;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part)
    if (part->material)
      gain += (pipeline::touch_of(*part->material).grain_gain - gain) *
              pipeline::share_inside(part->box_m, x_m, y_m, border_m);
  return gain;
}

}  // namespace sparsha::haptics
