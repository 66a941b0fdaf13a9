// The guide's part of a tick, and how far the hand is from the stone.
#include <algorithm>
#include <cmath>

#include "haptics/servo/haptic_renderer.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {

double HapticRenderer::height_above_m(const Eigen::Vector3d& hip_m) const noexcept {
  const Eigen::Vector3d local = hip_m - surface_->lattice.origin_m;
  return surface_->scale * (local.z() - touched_height(*surface_, local.x(), local.y(), shape()));
}

double HapticRenderer::away_m(const Eigen::Vector3d& hip_m) const noexcept {
  if (window_.object != nullptr) return 0.0;
  const SurfaceEffects* effects = surface_->effects.get();
  if (effects == nullptr || effects->stone_m.empty()) return 0.0;
  const double across_m = effects->to_stone_m(hip_m.x(), hip_m.y());
  // Beyond an outline the ground that is touched falls away; the stone does not.
  const double above_m =
      across_m > 0.0 ? surface_->scale * (hip_m.z() - effects->stone_z_m(hip_m.x(), hip_m.y())) : height_above_m(hip_m);
  return std::hypot(surface_->scale * across_m, std::max(0.0, above_m));
}

Guidance::Output HapticRenderer::guide(const Eigen::Vector3d& hip_m) noexcept {
  if (guidance_.phase() == GuidePhase::off || dragging_ || !armed_) return {};
  Guidance::Input input;
  input.hand_m = hip_m;
  input.velocity_m_per_s = governor_.velocity();
  input.scale = surface_->scale;
  input.scrolled_m = surface_->scale * (guided_at_m_ - centre_m_);
  input.stiffness_n_per_m = stiffness_n_per_m_;
  input.step_s = step_s();
  if (window_.object != nullptr) {
    input.velocity_m_per_s = object_.to_grid(input.velocity_m_per_s);
    Guidance::Output led = guidance_.update(input);
    led.force_n = object_.to_device(led.force_n);
    return led;
  }
  input.height_m = height_above_m(hip_m);
  for (Eigen::Vector3d* across : {&input.hand_m, &input.velocity_m_per_s, &input.scrolled_m}) across->z() = 0.0;
  return guidance_.update(input);
}

// What leads along a line, on top of what the surface gives.
void HapticRenderer::add_guide(GovernorInput& input, const Eigen::Vector3d& hip_m, bool fresh) noexcept {
  State& state = record_.state;
  Guidance::Output led;
  if (recorded_guide_)
    led = *recorded_guide_;
  else if (fresh)
    led = guide(hip_m);
  guided_at_m_ = centre_m_;
  state.guide = guidance_.phase();
  state.guide_rounds = guidance_.rounds();
  state.guide_n = to_array(led.force_n);
  state.guide_stored_j = led.stored_j;
  state.guide_supplied_j = led.supplied_j;
  input.guided = led.stored_j > 0.0 || !led.force_n.isZero(0.0);
  if (!input.guided) return;
  state.flags |= kFlagGuided;
  if (recorded_guide_) state.guide = GuidePhase::leading;
  input.force_n += led.force_n;
  input.spring_energy_j += led.stored_j;
  input.supplied_j = led.supplied_j;
}

}  // namespace sparsha::haptics
