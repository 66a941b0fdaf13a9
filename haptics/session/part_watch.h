// Which part of the object is worth saying while a hand goes over parts, parts in parts and their borders.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>

#include <Eigen/Core>

namespace sparsha::haptics {

/// A part is said when the hand comes to it. Where another one was said a moment ago, the hand has to be well inside or
/// to stay for a short while; where the hand was in the part a few seconds ago, to stay for a second, and for two and
/// four seconds where it comes back again and again. So a hand that stays is told where it is, at once in a part that
/// is new to it, and one that circles over a border is not told at every turn.
class PartWatch {
 public:
  /// Index of the part at a place, if any.
  using PartAt = std::function<std::optional<std::size_t>(const Eigen::Vector2d& place_m)>;

  /// A hand that touches the place at `time_s`. `margin_m`: how far from a border a place is well inside, in the same
  /// frame. The part that is to be said now, if any.
  [[nodiscard]] std::optional<std::size_t> watch(const Eigen::Vector2d& place_m, double margin_m, double time_s,
                                                 const PartAt& part_at);
  /// Another scene.
  void forget();

 private:
  struct Told {
    double here_s = -1e9;     // when the hand was last in it
    double patience_s = 0.0;  // of the next time, if that is soon
    bool fresh = true;        // the hand had not been in it for a while when it came
  };
  [[nodiscard]] double patience_s(const Told& told, double time_s) const;
  std::map<std::size_t, Told> told_;
  std::optional<std::size_t> part_;   // said last
  std::optional<std::size_t> there_;  // that the hand is in, said or not
  double since_s_ = 0.0;              // it has been in it
  double left_s_ = -1e9;              // when the hand was last in the part that was said last
  double spoke_s_ = -1e9;             // when any part was said last
};

}  // namespace sparsha::haptics
