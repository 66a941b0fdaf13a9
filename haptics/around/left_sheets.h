// The sheets that a proxy has left in one tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sparsha::haptics {

inline constexpr int kMostHandOvers = 8;  ///< a tick, edges included

/// A sheet that was left in this tick may be entered again only nearer to the hand: no going to and fro without end.
class LeftSheets {
 public:
  /// `distance_m`: from the hand to the proxy when it left. What is more than kMostHandOvers is not kept.
  void add(std::uint32_t sheet, double distance_m) noexcept {
    if (count_ < left_.size()) left_[count_++] = {sheet, distance_m};
  }
  [[nodiscard]] bool may_enter(std::uint32_t sheet, double distance_m) const noexcept {
    for (std::size_t k = 0; k < count_; ++k)
      if (left_[k].sheet == sheet && distance_m > left_[k].distance_m) return false;
    return true;
  }
  [[nodiscard]] bool any() const noexcept { return count_ > 0; }

 private:
  struct Left {
    std::uint32_t sheet;
    double distance_m;
  };
  std::array<Left, kMostHandOvers> left_;
  std::size_t count_ = 0;
};

}  // namespace sparsha::haptics
