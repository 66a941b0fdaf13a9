// Look-ahead limiter: hold the largest reduction over the window, release, then average over the window. The average of
// kWindow values that are each at least what the leaving frame asks for is at least that, so the ceiling holds.
#include "audio/limiter.h"

#include <algorithm>
#include <cmath>

namespace sparsha::audio {
namespace {

constexpr double kReleaseTime_s = 0.08;
/// Reductions under 1e-5 (0.0001 dB) end, so that the signal is exact again.
constexpr double kNegligible = 1e-5;

}  // namespace

Limiter::Limiter(double ceiling, double sample_rate_hz)
    : ceiling_(ceiling), release_(std::exp(-1.0 / (kReleaseTime_s * sample_rate_hz))) {}

Limiter::Frame Limiter::process(const Frame& in) noexcept {
  const double peak = std::max(std::abs(in.left), std::abs(in.right));
  const double wanted = peak > ceiling_ ? 1.0 - ceiling_ / peak : 0.0;
  if (reduction_[at_] > 0.0) --reducing_;
  if (wanted > 0.0) ++reducing_;
  reduction_[at_] = wanted;

  const double largest = reducing_ == 0 ? 0.0 : *std::max_element(reduction_.begin(), reduction_.end());
  held_ = std::max(largest, held_ * release_);
  if (held_ < kNegligible) held_ = largest;
  if (smooth_[at_] > 0.0) --smoothing_;
  if (held_ > 0.0) ++smoothing_;
  smooth_[at_] = held_;

  delay_[at_] = in;
  at_ = (at_ + 1) % kWindow;
  Frame out = delay_[at_];
  if (smoothing_ > 0) {
    double sum = 0.0;
    for (const double value : smooth_) sum += value;
    const double gain = 1.0 - sum / static_cast<double>(kWindow);
    // Rounding of the sum may miss the ceiling by an ulp or two.
    out.left = std::clamp(out.left * gain, -ceiling_, ceiling_);
    out.right = std::clamp(out.right * gain, -ceiling_, ceiling_);
  }
  return out;
}

}  // namespace sparsha::audio
