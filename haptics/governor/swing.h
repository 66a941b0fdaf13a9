// Does the hand swing on the wall's spring, and does that grow? Looks at the hand's motion along the surface's normal
// only, so that it needs to know neither the loop's delay nor the hand's mass and damping.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace sparsha::haptics {

/// Servo thread only; device frame.
class SwingDetector {
 public:
  enum class Finding : std::uint8_t { none, lasting, growing };
  struct Suspicion {
    bool alert = false;  ///< this hand has swung before: a small swing that does not decay is the next one
    bool wary = false;   ///< the loop jitters: a swing that decays slowly has to be helped
  };
  /// `hand_m`, `surface_m`: how far the hand and the touched point of the surface went along the mean normal since the
  /// last tick; `travel_m`: how far that point went at all; `step_m`: the encoder's. A swing that lasts is found at
  /// each turn, one that grows once.
  [[nodiscard]] Finding update(double period_s, double hand_m, double surface_m, double travel_m, double step_m,
                               const Suspicion& suspicion) noexcept;
  void reset() noexcept { *this = SwingDetector(); }

  /// Of the last half-swing; 0 before the first.
  [[nodiscard]] double size_m() const noexcept { return count_ > 0 ? half(0).size_m : 0.0; }
  [[nodiscard]] double half_period_s() const noexcept { return count_ > 0 ? half(0).time_s : 0.0; }
  /// Since the last reversal.
  [[nodiscard]] double quiet_s() const noexcept { return time_s_ - last_s_; }

 private:
  struct Half {
    double size_m = 0.0;
    double time_s = 0.0;
  };
  static constexpr std::size_t kKept = 16;

  [[nodiscard]] const Half& half(std::size_t back) const noexcept {
    return halves_[(next_ + kKept - 1 - back) % kKept];
  }
  [[nodiscard]] Finding turned(double step_m, const Suspicion& suspicion) noexcept;
  [[nodiscard]] Finding judge(double step_m, const Suspicion& suspicion) const noexcept;

  double time_s_ = 0.0;
  double hand_m_ = 0.0;
  double surface_m_ = 0.0;
  double travel_m_ = 0.0;   // of the touched point in this half-swing
  double extreme_m_ = 0.0;  // farthest of the present half-swing
  double extreme_s_ = 0.0;  // when
  double last_m_ = 0.0;     // where the last half-swing ended
  double last_s_ = 0.0;
  double surface_low_m_ = 0.0;  // of the surface since then
  double surface_high_m_ = 0.0;
  double direction_ = 0.0;
  std::array<Half, kKept> halves_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;  // half-swings in a row that are the hand's own
  std::size_t still_ = 0;  // of them on one place
  std::size_t large_ = 0;  // of them far larger than the surface's rise and fall
};

}  // namespace sparsha::haptics
