#include "haptics/effects/effect_forces.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {
namespace {

constexpr double kStiffnessStep = 0.02;  // smaller changes of a wish wait
constexpr double kMostDeviations = 6.0;  // of the grain's heights, from the lowest to the highest

}  // namespace

void EffectForces::reset() noexcept {
  impact_.reset();
  grain_.reset();
  grain_n_ = zeros();
  stored_j_ = 0.0;
  was_contact_ = false;
}

/// With the forces that the device held, so that the governor's books find as much: a height of the grain between two
/// ticks would not do.
double EffectForces::stored(const Input& input, double most_j) noexcept {
  const Eigen::Vector3d& held_n = grain_n_[std::min(input.delay_ticks, kLongestDelay)];
  stored_j_ = std::clamp(stored_j_ - held_n.dot(input.hand_m - last_m_), 0.0, most_j);
  return stored_j_;
}

double EffectForces::stiffness(double base_n_per_m, double share, const Eigen::Vector3d& place_m,
                               const SurfaceEffects& effects) noexcept {
  const double base = share > 0.0 ? base_n_per_m / share : 0.0;
  const double wished = share * effects.stiffness_at(place_m.x(), place_m.y(), base);
  const bool settled = wished == last_wished_n_per_m_;
  last_wished_n_per_m_ = wished;
  if (settled || std::abs(wished - stiffness_n_per_m_) > kStiffnessStep * stiffness_n_per_m_)
    stiffness_n_per_m_ = wished;
  return stiffness_n_per_m_;
}

EffectForces::Output EffectForces::update(const Input& input, const SurfaceEffects* effects) noexcept {
  Output output;
  const bool stayed = was_contact_ && input.contact;
  was_contact_ = input.contact;
  if (effects == nullptr) return output;
  const double pressed_n = input.contact ? std::max(0.0, input.force_n.dot(input.normal)) : 0.0;
  const double x_m = input.place_m.x();
  const double y_m = input.place_m.y();
  if (effects->impact) {
    Impact::Input strike;
    strike.period_s = input.period_s;
    strike.nominal_period_s = input.nominal_period_s;
    strike.hand_m = input.hand_m;
    strike.normal = input.normal;
    strike.contact = input.contact;
    strike.touch = input.touch;
    strike.approach_m_per_s = input.approach_m_per_s;
    strike.pressed_n = pressed_n;
    strike.material = input.touch ? &effects->material_at(x_m, y_m) : nullptr;
    output.force_n += impact_.update(strike) * input.normal;
  }
  if (effects->grain && !effects->field.silent()) {
    Grain::Input slide;
    slide.period_s = input.period_s;
    slide.nominal_period_s = input.nominal_period_s;
    slide.place_m = input.place_m.head<2>();
    slide.moved_m = input.moved_m - input.moved_m.dot(input.normal) * input.normal;
    slide.scale = effects->scale;
    slide.contact = stayed;
    const Grain::Output grain = grain_.update(slide, effects->field);
    const double press_n = pressed_n * effects->grain_gain_at(x_m, y_m);
    const Eigen::Vector3d slope =
        effects->region_from_grid.transpose() * Eigen::Vector3d(grain.slope.x(), grain.slope.y(), 0.0);
    const Eigen::Vector3d force_n = press_n * (slope.dot(input.normal) * input.normal - slope);
    output.force_n += force_n;
    output.stored_j = stored(input, kMostDeviations * press_n * effects->scale * grain.deviation_m);
    std::copy_backward(grain_n_.begin(), grain_n_.end() - 1, grain_n_.end());
    grain_n_[0] = force_n;
  }
  last_m_ = input.hand_m;
  return output;
}

}  // namespace sparsha::haptics
