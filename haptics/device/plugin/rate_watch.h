// Whether samples come as often as a driver says.
#pragma once

#include <cstdint>

namespace sparsha::haptics::plugin {

/// Counts over half seconds. Servo thread; no allocation.
class RateWatch {
 public:
  static constexpr double kWindow_s = 0.5;
  static constexpr double kLeast = 0.5, kMost = 1.5;  ///< of the rate that was said

  explicit RateWatch(double rate_hz) noexcept : rate_hz_(rate_hz) {}
  /// `time_s`: the servo's clock.
  void tick(double time_s, bool fresh) noexcept {
    if (!begun_ || time_s < begin_s_ || time_s - begin_s_ > 4.0 * kWindow_s) {  // or a program that was stopped
      begun_ = true;
      begin_s_ = time_s;
      count_ = 0;
    }
    if (fresh) ++count_;
    if (time_s - begin_s_ < kWindow_s) return;
    measured_hz_ = static_cast<double>(count_) / (time_s - begin_s_);
    wrong_ = measured_hz_ < kLeast * rate_hz_ || measured_hz_ > kMost * rate_hz_;
    begin_s_ = time_s;
    count_ = 0;
  }
  /// In the last half second that is over.
  [[nodiscard]] bool wrong() const noexcept { return wrong_; }
  [[nodiscard]] double measured_hz() const noexcept { return measured_hz_; }

 private:
  double rate_hz_;
  bool begun_ = false, wrong_ = false;
  double begin_s_ = 0.0, measured_hz_ = 0.0;
  std::uint64_t count_ = 0;
};

}  // namespace sparsha::haptics::plugin
