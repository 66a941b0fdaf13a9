// Turns actions into requests to the session, and remembers windows so that a visitor can go back to them.
#include "viewer/actions/wishes.h"

#include <cmath>

namespace sparsha::viewer {
namespace {

using Kind = haptics::Request::Kind;

constexpr double kPan = 0.25;        // window widths
constexpr double kTurn_deg = 45.0;   // of a whole object, as by the terminal's keys
constexpr double kAnswer_s = 1.0;    // a servo that has not followed by then will not
constexpr double kSameWidth = 0.02;  // share
constexpr int kMostTries = 16;
constexpr std::size_t kMostBefore = 64;

}  // namespace

bool Wishes::Toggle::flip(bool present, double time_s) {
  wished = !(time_s < until_s ? wished : present);
  until_s = time_s + kAnswer_s;
  return wished;
}

void Wishes::post(Kind kind, double x, double y, bool on, double z) {
  if (requests_ != nullptr) requests_->post({kind, x, y, on, z});
}

void Wishes::remember(const Window& window) {
  goal_.reset();
  if (!window.meant) return;
  before_.push_back({window.centre_m.head<2>(), window.width_m});
  if (before_.size() > kMostBefore) before_.erase(before_.begin());
}

void Wishes::drag(bool on, const Window& window) {
  if (on) remember(window);
  post(Kind::drag, 0.0, 0.0, on);
}

bool Wishes::act(Action action, const haptics::State& state, const Window& window) {
  const auto on = [&](std::uint64_t bit) { return (state.flags & bit) != 0; };
  const auto move = [&](Kind kind, double x = 0.0, double y = 0.0) {
    remember(window);
    post(kind, x, y);
    return true;
  };
  switch (action) {
    case Action::zoom_in:
      return move(Kind::zoom_in);
    case Action::zoom_out:
      return move(Kind::zoom_out);
    case Action::next_part:
      return move(Kind::next_part);
    case Action::previous_part:
      return move(Kind::previous_part);
    case Action::whole_scene:
      return move(Kind::whole_scene);
    case Action::pan_left:
      return move(Kind::pan, -kPan);
    case Action::pan_right:
      return move(Kind::pan, kPan);
    case Action::pan_up:
      return move(Kind::pan, 0.0, kPan);
    case Action::pan_down:
      return move(Kind::pan, 0.0, -kPan);
    case Action::texture:
      post(Kind::set_texture, 0.0, 0.0, texture_.flip(on(haptics::kFlagTexture), time_s_));
      return true;
    case Action::friction:
      post(Kind::set_friction, 0.0, 0.0, friction_.flip(on(haptics::kFlagFriction), time_s_));
      return true;
    case Action::stiffer:
      post(Kind::scale_stiffness, 1.25);
      return true;
    case Action::softer:
      post(Kind::scale_stiffness, 0.8);
      return true;
    // About the device's axes, as what is before the hand moves.
    case Action::turn_object_left:
      post(Kind::turn, 0.0, -kTurn_deg);
      return true;
    case Action::turn_object_right:
      post(Kind::turn, 0.0, kTurn_deg);
      return true;
    case Action::turn_object_up:
      post(Kind::turn, -kTurn_deg);
      return true;
    case Action::turn_object_down:
      post(Kind::turn, kTurn_deg);
      return true;
    case Action::roll_object:
      post(Kind::turn, 0.0, 0.0, false, kTurn_deg);
      return true;
    case Action::roll_object_back:
      post(Kind::turn, 0.0, 0.0, false, -kTurn_deg);
      return true;
    case Action::object_front:
      post(Kind::turn_back);
      return true;
    case Action::describe:
      post(Kind::describe);
      return true;
    case Action::tour:
      post(Kind::tour);
      return true;
    default:
      return false;
  }
}

void Wishes::move_to(const Eigen::Vector2d& centre_m, const Window& window) {
  if (!centre_m.allFinite()) return;
  remember(window);
  post(Kind::move_to, centre_m.x(), centre_m.y());
}

void Wishes::welcome_next() { post(haptics::Request::Kind::fresh_visitor); }

void Wishes::turn(const Eigen::Vector3d& axis_deg) { post(Kind::turn, axis_deg.x(), axis_deg.y(), true, axis_deg.z()); }

void Wishes::quit() { post(Kind::quit); }

bool Wishes::undo() {
  if (before_.empty()) return false;
  goal_ = before_.back();
  before_.pop_back();
  tries_ = 0;
  asked_s_ = -kAnswer_s;
  return true;
}

void Wishes::forget_windows() {
  before_.clear();
  goal_.reset();
}

void Wishes::update(double time_s, const haptics::State& state, const Window& window) {
  time_s_ = time_s;
  if (!goal_ || !window.meant) return;
  const bool answered = state.surface_id != surface_ || time_s - asked_s_ >= kAnswer_s;
  if (!answered) return;
  surface_ = state.surface_id;
  asked_s_ = time_s;
  const double ratio = window.width_m / goal_->width_m;
  if (std::abs(ratio - 1.0) <= kSameWidth || ++tries_ > kMostTries) {
    post(Kind::move_to, goal_->centre_m.x(), goal_->centre_m.y());
    goal_.reset();
    return;
  }
  post(ratio > 1.0 ? Kind::zoom_in : Kind::zoom_out);
}

}  // namespace sparsha::viewer
