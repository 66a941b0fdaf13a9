#include "haptics/governor/swing.h"

#include <cmath>

namespace sparsha::haptics {
namespace {

constexpr double kLeastTurn_m = 50e-6;  // smaller reversals are encoder and tremor
constexpr double kStepsPerTurn = 2.5;
constexpr double kLastingSteps = 3.2;
constexpr double kAlertTurn_m = 30e-6;  // of a hand that has swung before
constexpr double kAlertSteps = 1.6;
constexpr double kUndiminished = 0.95;
constexpr double kShortest_s = 0.003;  // of half a swing on a spring that a hand holds
constexpr double kLongest_s = 0.150;
constexpr double kOwn = 1.5;        // a swing this much larger than the surface's own rise and fall is the hand's
constexpr double kFarLarger = 4.0;  // than the surface's: no resonance of a hand that strokes
constexpr double kTelling_m = 120e-6;
constexpr double kSlowDecay = 0.5;   // over three swings
constexpr double kStill_m = 100e-6;  // a hand that touches one place

/// A swing of less may last: encoder and tremor.
double lasting_m(double step_m) noexcept { return std::max(kLeastTurn_m, kLastingSteps * step_m); }

}  // namespace

SwingDetector::Finding SwingDetector::update(double period_s, double hand_m, double surface_m, double travel_m,
                                             double step_m, const Suspicion& suspicion) noexcept {
  time_s_ += period_s;
  hand_m_ += hand_m;
  surface_m_ += surface_m;
  travel_m_ += travel_m;
  surface_low_m_ = std::min(surface_low_m_, surface_m_);
  surface_high_m_ = std::max(surface_high_m_, surface_m_);
  const double turn_m =
      suspicion.alert ? std::max(kAlertTurn_m, kAlertSteps * step_m) : std::max(kLeastTurn_m, kStepsPerTurn * step_m);
  if (direction_ == 0.0) {
    if (std::abs(hand_m_ - extreme_m_) < turn_m) return Finding::none;
    direction_ = std::copysign(1.0, hand_m_ - extreme_m_);
  }
  if (direction_ * (hand_m_ - extreme_m_) >= 0.0) {
    extreme_m_ = hand_m_;
    extreme_s_ = time_s_;
    return Finding::none;
  }
  return direction_ * (extreme_m_ - hand_m_) > turn_m ? turned(step_m, suspicion) : Finding::none;
}

SwingDetector::Finding SwingDetector::turned(double step_m, const Suspicion& suspicion) noexcept {
  const Half now{std::abs(extreme_m_ - last_m_), extreme_s_ - last_s_};
  const double surface_m = surface_high_m_ - surface_low_m_;
  const bool own = now.time_s >= kShortest_s && now.time_s <= kLongest_s && now.size_m > kOwn * surface_m + step_m;
  last_m_ = extreme_m_;
  last_s_ = extreme_s_;
  extreme_m_ = hand_m_;
  extreme_s_ = time_s_;
  surface_low_m_ = surface_high_m_ = surface_m_;
  direction_ = -direction_;
  count_ = own ? std::min(count_ + 1, kKept) : 0;
  still_ = own && travel_m_ < 0.5 * now.size_m + kStill_m ? std::min(still_ + 1, kKept) : 0;
  large_ = own && now.size_m > kFarLarger * surface_m + lasting_m(step_m) ? std::min(large_ + 1, kKept) : 0;
  travel_m_ = 0.0;
  if (!own) return Finding::none;
  halves_[next_] = now;
  next_ = (next_ + 1) % kKept;
  const Finding finding = judge(step_m, suspicion);
  if (finding == Finding::growing) count_ = still_ = large_ = 1;
  return finding;
}

// Fast growth tells after one swing, slow growth after several; swings are compared with those of the same side. A hand
// that strokes is pushed about by the stone, so that only regular growth over many swings is its own.
SwingDetector::Finding SwingDetector::judge(double step_m, const Suspicion& suspicion) const noexcept {
  const auto ratio = [this](std::size_t back, std::size_t from = 0) { return half(from).size_m / half(back).size_m; };
  const auto regular = [this](std::size_t halves, double most) {
    double shortest = half(0).time_s;
    double longest = shortest;
    for (std::size_t k = 1; k < halves; ++k) {
      shortest = std::min(shortest, half(k).time_s);
      longest = std::max(longest, half(k).time_s);
    }
    return longest <= most * shortest;
  };
  const auto steady = [&](std::size_t halves, double least) {
    for (std::size_t k = 0; k + 2 < halves; ++k)
      if (ratio(k + 2, k) < least) return false;
    return true;
  };
  const double least_m = lasting_m(step_m);
  if (half(0).size_m >= kTelling_m) {
    if (still_ >= 3 && ratio(1) > 1.8 && ratio(2) > 4.0) return Finding::growing;
    if (still_ >= 4 && ratio(2) > 1.3 && ratio(3, 1) > 1.15) return Finding::growing;
    if (still_ >= 8 && ratio(6) > 1.2 && ratio(2) > 1.0 && ratio(4) > 1.05) return Finding::growing;
    if (still_ >= 14 && ratio(12) > 1.1 && ratio(6) > 1.03) return Finding::growing;
    if (count_ >= 4 && regular(4, 1.5) && steady(4, 2.0) && ratio(1) > 1.2) return Finding::growing;
    if (count_ >= 8 && regular(8, 1.25) && steady(8, 1.08)) return Finding::growing;
    if (count_ >= 16 && regular(16, 1.25) && steady(16, 1.0) && ratio(14) > 1.15) return Finding::growing;
  }
  if (suspicion.alert && still_ >= 4 && ratio(2) > kUndiminished && ratio(3, 1) > kUndiminished)
    return Finding::lasting;
  if (suspicion.wary && (still_ >= 8 || (large_ >= 8 && regular(8, 1.25))) && half(0).size_m > least_m &&
      ratio(6) > kSlowDecay && ratio(7, 1) > kSlowDecay)
    return Finding::lasting;
  if (suspicion.wary && suspicion.alert && (still_ >= 4 || (large_ >= 4 && regular(4, 1.5))) &&
      std::min({half(0).size_m, half(1).size_m, half(2).size_m, half(3).size_m}) > least_m)
    return Finding::lasting;
  if (large_ >= 16 && half(0).size_m > kTelling_m && regular(16, 1.25) && ratio(14) > 0.85 && ratio(15, 1) > 0.85)
    return Finding::lasting;
  if (still_ >= 14 && half(0).size_m > least_m && ratio(12) > 0.85 && ratio(6) > 0.9 && ratio(13, 1) > 0.85)
    return Finding::lasting;
  return Finding::none;
}

}  // namespace sparsha::haptics
