// Keeps peaks under a ceiling without clipping: gain falls smoothly during 1 ms of look-ahead and recovers in 80 ms.
#pragma once

#include <array>
#include <cstddef>

namespace sparsha::audio {

/// Stereo-linked. Below the ceiling the signal passes unchanged, bit for bit, kDelay frames late. No allocation.
class Limiter {
 public:
  static constexpr std::size_t kDelay = 48;  ///< frames

  /// `ceiling`: largest sample magnitude that comes out.
  Limiter(double ceiling, double sample_rate_hz);

  struct Frame {
    double left = 0.0;
    double right = 0.0;
  };
  /// Takes one frame, returns the one of kDelay frames ago.
  Frame process(const Frame& in) noexcept;

 private:
  static constexpr std::size_t kWindow = kDelay + 1;
  double ceiling_;
  double release_;
  std::size_t at_ = 0;
  std::array<Frame, kWindow> delay_{};
  std::array<double, kWindow> reduction_{};  ///< 1 - gain that each frame of the window asks for
  std::array<double, kWindow> smooth_{};     ///< the same, held over the window and released slowly
  std::size_t reducing_ = 0;                 ///< frames of reduction_ that ask for anything
  std::size_t smoothing_ = 0;                ///< frames of smooth_ that are not 0
  double held_ = 0.0;
};

}  // namespace sparsha::audio
