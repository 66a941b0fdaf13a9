// The velocity of a hand that is read through an encoder: a fit over as many of the last samples as one straight line
// explains, so that a slow hand is seen without the encoder's noise and a fast one without lag. First-order adaptive
// windowing, best fit, after Janabi-Sharifi, Hayward and Chen, IEEE Trans. Control Systems Technology 8 (2000) 1003.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace sparsha::haptics {

/// Of an encoder that has not shown its step yet.
inline constexpr double kLikelyEncoderStep_m = 50e-6;

/// Servo thread only; no allocation. Metres, seconds, any frame.
class AdaptiveVelocity {
 public:
  /// Longest window.
  static constexpr double kLongest_s = 0.024;
  /// Samples that are closer are left out: one step of the encoder within less would seem a fast hand.
  static constexpr double kClosest_s = 0.00024;

  /// A sample; `period_s` since the one before it, 0 or less for the first of all.
  void add(const Eigen::Vector3d& position_m, double period_s) noexcept;
  void reset() noexcept { count_ = 0; }

  /// m/s, axis by axis: the slope of the longest window whose samples all lie within `noise_m` of the line between its
  /// ends. `noise_m`: the encoder's step, with what else the position errs by. Zero before the second sample. Some
  /// 10 ns a sample of the window.
  [[nodiscard]] Eigen::Vector3d velocity(double noise_m) const noexcept;

 private:
  static constexpr std::size_t kMost = 104;
  struct Sample {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    double time_s = 0.0;
  };
  [[nodiscard]] const Sample& back(std::size_t samples) const noexcept {
    return samples_[(next_ + kMost - 1 - samples) % kMost];
  }
  [[nodiscard]] std::size_t nearest() const noexcept;
  [[nodiscard]] std::size_t window(Eigen::Index axis, double noise_m) const noexcept;

  std::array<Sample, kMost> samples_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  double time_s_ = 0.0;
};

}  // namespace sparsha::haptics
