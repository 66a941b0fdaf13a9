// The sound of a finger drawn over stone: band-passed noise that follows speed, force and roughness.
//
// Its power is proportional to the power that friction dissipates, mu F_n v (van den Doel et al. 2001, FoleyAutomatic);
// its band's centre is v over the length of a grain, as asperities pass under the finger.
#pragma once

#include <cstdint>

#include "base/hash.h"

namespace sparsha::audio {

/// What the hand does; SI, device frame.
struct ScrapeInput {
  double speed_m_per_s = 0.0;  ///< of the proxy along the surface
  double normal_force_n = 0.0;
  double friction_coefficient = 0.0;
};

/// One channel. Parameters glide, so that control steps are not heard; exact zeros at rest. No allocation; one thread.
class Scrape {
 public:
  Scrape(double gain, double sample_rate_hz);

  void set(const ScrapeInput& input) noexcept;
  [[nodiscard]] bool sounding() const noexcept { return level_ > 0.0 || target_level_ > 0.0; }
  [[nodiscard]] double next() noexcept;

 private:
  double noise() noexcept;
  void retune() noexcept;

  double gain_;
  double sample_rate_hz_;
  double level_glide_, frequency_glide_;
  double target_level_ = 0.0, level_ = 0.0;
  double target_frequency_hz_, frequency_hz_;
  double warped_ = 0.0;     ///< tan(pi f / rate)
  double normalise_ = 0.0;  ///< makes the band's root mean square 1
  double state_1_ = 0.0, state_2_ = 0.0;
  std::uint32_t until_retune_ = 0;
  std::uint64_t random_ = kGoldenStep;
};

}  // namespace sparsha::audio
