#include "haptics/effects/effect_forces.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {
namespace {

constexpr double kStiffnessStep = 0.02;  // smaller changes of a wish wait
constexpr double kMostDeviations = 6.0;  // of the grain's heights, from the lowest to the highest
constexpr double kLatest_s = 0.004;      // from a tick to the hand
constexpr double kLeak_w = 0.0003;       // of what the grain gives, that every hand takes
constexpr double kBearable_j = 0.0002;   // beyond that and the grain's own heights it becomes weaker

}  // namespace

void EffectForces::reset() noexcept {
  impact_.reset();
  cues_.reset();
  grain_.reset();
  grain_n_ = zeros();
  stored_j_ = 0.0;
  given_j_.fill(0.0);
  was_contact_ = false;
}

/// With the forces that the device held, so that the governor observes the same energy: a height of the grain between
/// two ticks would not do.
double EffectForces::stored(const Input& input, double most_j) noexcept {
  const Eigen::Vector3d& held_n = grain_n_[std::min(input.delay_ticks, kLongestDelay)];
  stored_j_ = std::clamp(stored_j_ - held_n.dot(input.hand_m - last_m_), 0.0, most_j);
  return stored_j_;
}

double EffectForces::stiffness(double base_n_per_m, double share, const Eigen::Vector3d& place_m,
                               const SurfaceEffects& effects) noexcept {
  const double base = share > 0.0 ? base_n_per_m / share : 0.0;
  const double wished = share * effects.stiffness_at(place_m, base);
  const bool settled = wished == last_wished_n_per_m_;
  last_wished_n_per_m_ = wished;
  if (settled || std::abs(wished - stiffness_n_per_m_) > kStiffnessStep * stiffness_n_per_m_)
    stiffness_n_per_m_ = wished;
  return stiffness_n_per_m_;
}

/// The share of the grain that the loop bears. A hand that yields to a force which comes late gets more than it gave;
/// how late is not known, so that the worst of all delays counts.
double EffectForces::bearable(const Input& input, double most_j) noexcept {
  const Eigen::Vector3d moved_m = input.hand_m - last_m_;
  const double leaked_j = kLeak_w * std::min(input.period_s, input.pace_s);
  double worst_j = 0.0;
  for (std::size_t k = 0; k <= kLongestDelay && static_cast<double>(k) * input.pace_s <= kLatest_s; ++k) {
    given_j_[k] = std::max(-most_j, given_j_[k] + grain_n_[k].dot(moved_m) - leaked_j);
    worst_j = std::max(worst_j, given_j_[k]);
  }
  return std::clamp(1.0 - (worst_j - most_j) / kBearable_j, 0.0, 1.0);
}

EffectForces::Output EffectForces::update(const Input& input, const SurfaceEffects* effects) noexcept {
  Output output;
  const bool stayed = was_contact_ && input.contact;
  was_contact_ = input.contact;
  if (!stayed) grain_n_ = zeros();
  if (effects == nullptr) return output;
  const double pressed_n = input.contact ? std::max(0.0, input.force_n.dot(input.normal)) : 0.0;
  Cues::Input cue;
  cue.period_s = input.period_s;
  cue.pace_s = input.pace_s;
  cue.time_s = input.time_s;
  cue.place_m = input.place_m;
  cue.normal = input.normal;
  cue.pressed_n = pressed_n;
  cue.scale = input.scale;
  cue.contact = input.contact;
  cue.outside = input.outside;
  cue.unknown = input.unknown;
  if (effects->cues) output.force_n += cues_.update(cue, effects);
  if (effects->impact) {
    Impact::Input strike;
    strike.period_s = input.period_s;
    strike.pace_s = input.pace_s;
    strike.hand_m = input.hand_m;
    strike.normal = input.normal;
    strike.contact = input.contact;
    strike.touch = input.touch;
    strike.approach_m_per_s = input.approach_m_per_s;
    strike.pressed_n = pressed_n;
    strike.material = input.touch ? &effects->material_at(input.place_m) : nullptr;
    output.force_n += impact_.update(strike) * input.normal;
  }
  if (effects->grain && !effects->field.silent()) {
    Grain::Input slide;
    slide.period_s = input.period_s;
    slide.pace_s = input.pace_s;
    slide.place_m = input.place_m;
    Eigen::Matrix3d device_from_region = effects->region_from_grid.transpose();
    if (input.device_from_grid != nullptr) {
      device_from_region = *input.device_from_grid * device_from_region;
      slide.shares = scene::GrainField::shares(device_from_region.transpose() * input.normal);
    }
    slide.moved_m = input.moved_m - input.moved_m.dot(input.normal) * input.normal;
    slide.scale = effects->scale;
    slide.contact = stayed;
    const Grain::Output grain = grain_.update(slide, effects->field);
    const double press_n = pressed_n * effects->grain_gain_at(input.place_m);
    const Eigen::Vector3d slope = device_from_region * grain.slope;
    const double most_j = kMostDeviations * press_n * effects->scale * grain.deviation_m;
    const double share = bearable(input, most_j);
    const Eigen::Vector3d force_n = share * press_n * (slope.dot(input.normal) * input.normal - slope);
    output.force_n += force_n;
    output.stored_j = stored(input, most_j);
    std::copy_backward(grain_n_.begin(), grain_n_.end() - 1, grain_n_.end());
    grain_n_[0] = force_n;
  }
  last_m_ = input.hand_m;
  return output;
}

}  // namespace sparsha::haptics
