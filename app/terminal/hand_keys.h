// Keys of a terminal as a hand: where they want it, how hard it presses, and how far the stone comes along.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "app/terminal/typed_keys.h"
#include "base/phrases/phrases.h"
#include "haptics/device/steered/steering_script.h"
#include "haptics/session/navigator.h"
#include "haptics/state/state.h"

namespace sparsha::app {

/// Arrows and the number pad move the hand by steps; a key that is held moves it steadily. Terminals do not tell when
/// a key is let go: repetitions only keep the hand going and add no way that would be left to go afterwards.
class HandKeys {
 public:
  /// What a visitor is to hear of a key.
  struct Words {
    Phrase phrase;
    PhraseValues values;
  };
  /// Whether the key is the hand's; `words` of what it did, if any. `state` of the present tick.
  bool press(const TypedKey& key, double time_s, const haptics::State& state, const Phrases& phrases);
  [[nodiscard]] std::optional<Words> take_words() { return std::exchange(words_, std::nullopt); }

  struct Wish {
    haptics::SteeringSample hand;
    Eigen::Vector2d scroll = Eigen::Vector2d::Zero();  ///< of the window, workspace widths per second
  };
  /// Where the stone ends, grid frame: the hand stops a little before it.
  struct Stone {
    Eigen::Vector2d low_m = Eigen::Vector2d::Constant(-1e9);
    Eigen::Vector2d high_m = Eigen::Vector2d::Constant(1e9);
  };
  /// Call some hundred times a second. `range`: where the window's centre can go.
  [[nodiscard]] Wish update(const haptics::State& state, const haptics::CentreRange& range, const Stone& stone);

 private:
  void step(const Eigen::Vector2d& direction, bool repeats, const haptics::State& state);
  void change_step(int by, const haptics::State& state, const Phrases& phrases);
  void change_press(int by);
  void follow_window(const haptics::State& state);
  [[nodiscard]] double step_m() const;
  [[nodiscard]] double speed_m_per_s() const;

  Eigen::Vector2d goal_m_ = Eigen::Vector2d::Zero();  // device frame; beyond the reach where the window is to follow
  std::size_t step_ = 2;
  std::size_t press_ = 2;
  bool lifted_ = false;
  TypedKey last_key_;
  double last_s_ = -1e9;
  std::array<double, 3> centre_m_{};
  double scale_ = 0.0;
  Eigen::Vector2d end_ = Eigen::Vector2d::Zero();  // directions in which the reach's end has been said
  std::uint64_t sequence_ = 0;
  std::optional<Words> words_;
};

}  // namespace sparsha::app
