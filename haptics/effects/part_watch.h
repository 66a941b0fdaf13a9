// Which part of the object is worth telling of while a hand goes over parts, parts in parts and their borders.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A part is told of when the hand comes to it. Where another one was told of a moment ago, the hand has to be well
/// inside or to stay for a short while; where the hand was in the part a few seconds ago, to stay for a second, and for
/// two and four seconds where it comes back again and again. So a hand that stays is told where it is, at once in a
/// part that is new to it, and one that circles over a border is not told at every turn. No allocation.
class PartWatch {
 public:
  /// A hand that touches the place at `time_s`. `margin_m`: how far from a border a place is well inside, in the same
  /// frame. `part_at(place_m)`: index of the part there, an optional. The part that is to be told of now, if any.
  template <class PartAt>
  [[nodiscard]] std::optional<std::size_t> watch(const Eigen::Vector2d& place_m, double margin_m, double time_s,
                                                 const PartAt& part_at) noexcept {
    const std::optional<std::size_t> here = part_at(place_m);
    const std::optional<double> stay_s = stays(here, time_s);
    // Near the border of the part that was told of last, the hand is still in that one.
    if (!stay_s || (borders(*stay_s, *here, time_s) && nearby(place_m, margin_m, part_, part_at))) return std::nullopt;
    return tell(*here, time_s);
  }
  /// After watch(): the hand has left the part that was told of last for none: it is `margin_m` away from it or has
  /// been out of all parts for a short while. Once.
  template <class PartAt>
  [[nodiscard]] bool left(const Eigen::Vector2d& place_m, double margin_m, double time_s,
                          const PartAt& part_at) noexcept {
    if (there_ || !inside_) return false;
    if (time_s - since_s_ < kShort_s && nearby(place_m, margin_m, part_, part_at)) return false;
    inside_ = false;
    return true;
  }
  /// Another scene.
  void forget() noexcept { *this = PartWatch(); }

 private:
  static constexpr std::size_t kDirections = 8;
  static constexpr std::size_t kRemembered = 32;  // parts; of more, those that the hand left first are forgotten
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  static constexpr double kShort_s = 0.25;  // of a stay; words are faster than a decision to go elsewhere

  struct Told {
    std::size_t part = kNone;
    double here_s = -1e9;     // when the hand was last in it
    double patience_s = 0.0;  // of the next time, if that is soon
    bool fresh = true;        // the hand had not been in it for a while when it came
  };
  template <class PartAt>
  [[nodiscard]] static bool nearby(const Eigen::Vector2d& place_m, double margin_m,
                                   const std::optional<std::size_t>& part, const PartAt& part_at) noexcept {
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kDirections;
      if (part_at(place_m + margin_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))) == part) return true;
    }
    return false;
  }
  [[nodiscard]] Told& told_of(std::size_t part) noexcept;
  [[nodiscard]] double patience_s(const Told& told, double time_s) const noexcept;
  /// For how long the hand has stayed in a part that is to be told of; absent where there is nothing to tell.
  [[nodiscard]] std::optional<double> stays(const std::optional<std::size_t>& here, double time_s) noexcept;
  [[nodiscard]] bool borders(double stay_s, std::size_t here, double time_s) const noexcept;
  [[nodiscard]] std::size_t tell(std::size_t here, double time_s) noexcept;

  std::array<Told, kRemembered> told_{};
  std::optional<std::size_t> part_;   // told of last
  std::optional<std::size_t> there_;  // that the hand is in, told of or not
  bool inside_ = false;               // part_, as far as was told
  double since_s_ = 0.0;              // it has been in it
  double left_s_ = -1e9;              // when the hand was last in the part that was told of last
  double spoke_s_ = -1e9;             // when any part was told of last
};

}  // namespace sparsha::haptics
