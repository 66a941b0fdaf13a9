#include "app/terminal/hand_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"

namespace sparsha::app {
namespace {

using Kind = TypedKey::Kind;

constexpr std::array kSteps_m = {0.001, 0.002, 0.005, 0.01, 0.02};  // at the hand
constexpr std::array kPresses_n = {0.3, 0.6, 1.0, 1.6, 2.4, 3.5};
constexpr double kStepsPerSecond = 8.0;  // as fast as people press a key
constexpr double kSlowest_m_per_s = 0.02, kFastest_m_per_s = 0.12;
constexpr double kRepeat_s = 0.075;      // the same key again within is held; people are not so fast
constexpr double kLead_s = 0.15;         // of the goal before the hand, of a key that is held
constexpr double kMostAhead = 8.0;       // steps that are kept
constexpr double kInner = 0.40;          // workspace widths to each side; beyond, the window goes instead
constexpr double kOuter = 0.485;         // at the ends of the stone
constexpr double kBeforeEdge_m = 0.001;  // at the hand, that stops so far before the stone's end
constexpr double kJump_m = 0.004;        // at the hand: the window was moved, it does not scroll
constexpr double kFastestScroll = 1.5;   // workspace widths per second

/// Unit direction of a key that moves the hand, or zero.
Eigen::Vector2d direction_of(const TypedKey& key) {
  const double d = std::sqrt(0.5);
  switch (key.kind) {
    case Kind::up:
      return {0.0, 1.0};
    case Kind::down:
      return {0.0, -1.0};
    case Kind::left:
      return {-1.0, 0.0};
    case Kind::right:
      return {1.0, 0.0};
    case Kind::home:
      return {-d, d};
    case Kind::page_up:
      return {d, d};
    case Kind::end:
      return {-d, -d};
    case Kind::page_down:
      return {d, -d};
    default:
      break;
  }
  if (key.kind != Kind::letter || key.letter < '1' || key.letter > '9' || key.letter == '5')
    return Eigen::Vector2d::Zero();
  const int place = key.letter - '1';  // rows of three, the lowest first
  return Eigen::Vector2d(place % 3 - 1, place / 3 - 1).normalized();
}

}  // namespace

double HandKeys::step_m() const { return kSteps_m.at(step_); }

double HandKeys::speed_m_per_s() const {
  return std::clamp(kStepsPerSecond * step_m(), kSlowest_m_per_s, kFastest_m_per_s);
}

void HandKeys::step(const Eigen::Vector2d& direction, bool repeats, const haptics::State& state) {
  const Eigen::Vector2d hand_m(state.device_m[0], state.device_m[1]);
  const double most_m = repeats ? std::max(step_m(), kLead_s * speed_m_per_s()) : kMostAhead * step_m();
  // What is left to go the other way was another wish.
  const double ahead_m = (goal_m_ - hand_m).dot(direction);
  const double from_m = ahead_m < -0.5 * step_m() ? 0.0 : ahead_m;
  goal_m_ += (std::min(from_m + step_m(), std::max(from_m, most_m)) - ahead_m) * direction;
}

void HandKeys::change_step(int by, const haptics::State& state, const Phrases& phrases) {
  step_ = by > 0 ? std::min(step_ + 1, kSteps_m.size() - 1) : step_ - std::min<std::size_t>(step_, 1);
  const double scale = state.scale > 0.0 ? state.scale : 1.0;
  words_ = Words{"hand_step", {{"distance", phrases.height(step_m() / scale)}}};
}

void HandKeys::change_press(int by) {
  press_ = by > 0 ? std::min(press_ + 1, kPresses_n.size() - 1) : press_ - std::min<std::size_t>(press_, 1);
  lifted_ = false;
  words_ = Words{"hand_press", {{"number", fmt::format("{:.1f}", kPresses_n.at(press_))}}};
}

bool HandKeys::press(const TypedKey& key, double time_s, const haptics::State& state, const Phrases& phrases) {
  if (const Eigen::Vector2d direction = direction_of(key); !direction.isZero(0.0)) {
    const bool repeats = key == last_key_ && time_s - last_s_ < kRepeat_s;
    last_key_ = key;
    last_s_ = time_s;
    step(direction, repeats, state);
    return true;
  }
  if (key.kind == Kind::insert || key.letter == '0' || key.letter == 'l' || key.letter == 'L') {
    lifted_ = !lifted_;
    words_ = Words{lifted_ ? Phrase("hand_lifted") : Phrase("hand_down"), {}};
    return true;
  }
  switch (key.letter) {
    case '*':
    case ']':
      change_step(+1, state, phrases);
      return true;
    case '/':
    case '[':
      change_step(-1, state, phrases);
      return true;
    case 'd':
    case 'D':
      change_press(+1);
      return true;
    case 'u':
    case 'U':
      change_press(-1);
      return true;
    default:
      return false;
  }
}

// What the window has gone is no longer to go. One that was moved at once leaves the hand where it is.
void HandKeys::follow_window(const haptics::State& state) {
  const Eigen::Vector2d moved_m =
      state.scale * Eigen::Vector2d(state.centre_m[0] - centre_m_[0], state.centre_m[1] - centre_m_[1]);
  const bool same = state.scale == scale_ && moved_m.allFinite() && moved_m.norm() <= kJump_m;
  const double reach_m = kInner * state.workspace_m;
  for (int axis = 0; axis < 2; ++axis) {
    const double beyond_m = goal_m_[axis] - std::clamp(goal_m_[axis], -reach_m, reach_m);
    const double gone_m = std::copysign(std::min(std::abs(moved_m[axis]), std::abs(beyond_m)), beyond_m);
    if (!same)
      goal_m_[axis] -= beyond_m;
    else if (moved_m[axis] * beyond_m > 0.0)
      goal_m_[axis] -= gone_m;
  }
  centre_m_ = state.centre_m;
  scale_ = state.scale;
}

HandKeys::Wish HandKeys::update(const haptics::State& state, const haptics::CentreRange& range, const Stone& stone) {
  Wish wish;
  wish.hand.press_n = lifted_ ? 0.0 : kPresses_n.at(press_);
  wish.hand.speed_m_per_s = speed_m_per_s();
  wish.hand.armed = (state.flags & haptics::kFlagArmed) != 0 ? 1 : 0;
  wish.hand.sequence = ++sequence_;
  if (state.tick == 0 || !(state.workspace_m > 0.0)) return wish;
  follow_window(state);
  const double inner_m = kInner * state.workspace_m, outer_m = kOuter * state.workspace_m;
  for (int axis = 0; axis < 2; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double side = goal_m_[axis] < 0.0 ? -1.0 : 1.0;
    const bool follows = side > 0.0 ? state.centre_m[k] < range.high_m[axis] : state.centre_m[k] > range.low_m[axis];
    // Beyond the stone the surface falls away.
    const double edge_m =
        state.scale * (side > 0.0 ? stone.high_m[axis] - state.centre_m[k] : state.centre_m[k] - stone.low_m[axis]);
    const double limit_m = follows ? inner_m : std::clamp(edge_m - kBeforeEdge_m, 0.0, outer_m);
    const double beyond_m = std::max(0.0, std::abs(goal_m_[axis]) - limit_m);
    wish.hand.wanted_m[k] = goal_m_[axis] - side * beyond_m;
    if (!(beyond_m > 0.0)) {
      if (end_[axis] * side > 0.0 && std::abs(goal_m_[axis]) <= std::min(inner_m, limit_m - 0.004)) end_[axis] = 0.0;
      continue;
    }
    if (!follows) {
      goal_m_[axis] = side * limit_m;
      if (end_[axis] != side) words_ = Words{"hand_end", {}};
      end_[axis] = side;
    } else if (side * state.device_m[k] > limit_m - 0.004) {
      const double speed = std::min(wish.hand.speed_m_per_s, beyond_m / 0.05) / state.workspace_m;
      wish.scroll[axis] = side * std::min(speed, kFastestScroll);
    }
  }
  return wish;
}

}  // namespace sparsha::app
