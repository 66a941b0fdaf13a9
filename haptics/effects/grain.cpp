#include "haptics/effects/grain.h"

#include <algorithm>
#include <cmath>

#include "base/numbers/smooth_step.h"

namespace sparsha::haptics {
namespace {

constexpr double kStill_m_per_s = 0.005;  // an encoder's flicker seems to move so fast
constexpr double kMoving_m_per_s = 0.020;
constexpr double kSlow_s = 0.016;
constexpr double kFast_s = 0.004;
constexpr double kPeriodShare = 0.05;
constexpr double kWhole = 0.46;          // waves per tick up to which a band is whole
constexpr double kNyquist = 0.5;         // and from which it is gone
constexpr double kShortest_m = 0.00012;  // at the hand: shorter waves are below an encoder's steps
constexpr double kSteepest = 0.5;

}  // namespace

Grain::Output Grain::update(const Input& input, const scene::GrainField& field) noexcept {
  Output output;
  const double period_s = std::max(input.period_s, 0.1 * input.pace_s);
  period_s_ = period_s_ > 0.0 ? period_s_ + kPeriodShare * (period_s - period_s_) : input.pace_s;
  const Eigen::Vector3d velocity = input.contact ? Eigen::Vector3d(input.moved_m / period_s) : Eigen::Vector3d::Zero();
  slow_m_per_s_ += (velocity - slow_m_per_s_) * std::min(1.0, period_s / kSlow_s);
  fast_m_per_s_ += (velocity - fast_m_per_s_) * std::min(1.0, period_s / kFast_s);
  const double speed = slow_m_per_s_.norm();
  const double share = smooth_step((speed - kStill_m_per_s) / (kMoving_m_per_s - kStill_m_per_s));
  if (!input.contact || !(share > 0.0) || !input.place_m.allFinite()) return output;
  const double per_tick_m =
      std::max(speed, fast_m_per_s_.norm()) / input.scale * std::max({period_s_, input.pace_s, period_s});
  double variance_m2 = 0.0;
  for (int band = 0; band < field.bands(); ++band) {
    const double highest_per_m = field.highest_per_m(band);
    const double waves = highest_per_m * per_tick_m;
    if (waves >= kNyquist || highest_per_m * kShortest_m > input.scale) break;
    const double weight = share * std::clamp((kNyquist - waves) / (kNyquist - kWhole), 0.0, 1.0);
    output.slope += weight * field.slope(band, input.place_m, input.shares);
    variance_m2 += std::pow(weight * field.deviation_m(band), 2);
  }
  output.deviation_m = std::sqrt(variance_m2);
  const double steepness = output.slope.norm();
  if (steepness > kSteepest) output.slope *= kSteepest / steepness;
  return output;
}

}  // namespace sparsha::haptics
