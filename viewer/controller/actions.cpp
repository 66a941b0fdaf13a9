// Keys and buttons to what they do.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "scene/scene.h"
#include "viewer/controller/controller.h"

namespace sparsha::viewer {
namespace {

constexpr double kHandStep_m = 0.002;  // one arrow key
constexpr double kLightStep_rad = std::numbers::pi / 12.0;
constexpr double kCloser = 1.15;
const char* const kRescanQuestion = "Scan again from this side?";

struct LightPreset {
  const char* name;
  KeyLight light;
};
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array kLights{LightPreset{"upper left", {}},
                             LightPreset{"raking from the left", {180.0 * kDegree, 0.17}},
                             LightPreset{"raking from above", {90.0 * kDegree, 0.17}},
                             LightPreset{"raking from the right", {0.0, 0.17}},
                             LightPreset{"raking from below", {-90.0 * kDegree, 0.17}},
                             LightPreset{"from the front", {135.0 * kDegree, 1.3}}};

}  // namespace

std::vector<Action> Controller::buttons() const {
  std::vector<Action> result;
  for (const ActionInfo& info : all_actions()) {
    if (info.action == Action::mode && !frame_.has_pointer) continue;
    if (of_whole_objects(info.action) && !(scene_ && is_whole(scene_->description()))) continue;
    if (frame_.settings.kiosk ? info.kiosk_button : info.button) result.push_back(info.action);
  }
  return result;
}

void Controller::move_focus(int step) {
  const std::vector<Action> list = buttons();
  const int count = static_cast<int>(list.size());
  frame_.focused = frame_.focused < 0 ? (step > 0 ? 0 : count - 1) : (frame_.focused + step + count) % count;
  const ActionInfo& info = info_of(list[static_cast<std::size_t>(frame_.focused)]);
  std::string value;
  const auto state_of = [&](bool there, std::uint64_t flag) {
    return !there ? ", none" : (frame_.state.flags & flag) != 0 ? ", on" : ", off";
  };
  if (info.action == Action::texture) value = state_of(frame_.has_texture, haptics::kFlagTexture);
  if (info.action == Action::friction) value = state_of(frame_.has_friction, haptics::kFlagFriction);
  if (info.action == Action::colour) value = fmt::format(", {}", name_of(frame_.settings.colour));
  if (connections_.speak) connections_.speak(fmt::format("{}{}: {}", info.label, value, info.what));
}

void Controller::press(const KeyPress& press) {
  if (marking_.press(press)) return;
  if (frame_.asks_rescan && !press.repeated && (press.key == key::kEnter || press.key == 'Y')) return answer(true);
  if (frame_.asks_rescan && !press.repeated && press.key == 'N') return answer(false);
  if (frame_.focused >= 0 && press.key == key::kEnter && !press.repeated) {
    const std::vector<Action> list = buttons();
    act(list[std::min(static_cast<std::size_t>(frame_.focused), list.size() - 1)]);
    return;
  }
  const auto action = action_of(press, frame_.settings.kiosk);
  if (action == Action::drag) drag_key_ = press.key;
  if (action) act(*action);
}

void Controller::release(int key) {
  if (key == 0 || key != drag_key_) return;
  drag_key_ = 0;
  if (scene_) wishes_.drag(false, window());
}

void Controller::begin_drag() {
  hand_.forget_aim();
  if (scene_) wishes_.drag(true, window());
}

void Controller::act(Action action) {
  const bool window_known = scene_ != nullptr;
  if (window_known && wishes_.act(action, frame_.state, window())) return;
  if (step_hand(action) || set_light(action) || move_camera(action) || set_view(action) || set_stereo(action) ||
      set_marks(action))
    return;
  switch (action) {
    case Action::drag:
      return begin_drag();
    case Action::home:
      return go_home();
    case Action::undo:
      if (!wishes_.undo()) tell("No earlier window");
      return;
    case Action::rescan:
      return ask_rescan();
    case Action::orient:
      return go_to_scans();
    case Action::next_scene:
    case Action::previous_scene:
      if (connections_.next_scene) connections_.next_scene(action == Action::next_scene ? 1 : -1);
      return;
    case Action::next_item:
      return move_focus(1);
    case Action::previous_item:
      return move_focus(-1);
    case Action::save_scene:
      if (connections_.save_scene)
        connections_.save_scene();
      else
        tell("This scene was opened without its scans");
      return;
    case Action::screenshot:
      screenshot_ = true;
      return;
    case Action::full_screen:
      full_screen_ = true;
      return;
    case Action::escape:
      return close_or_leave();
    case Action::quit:
      return leave();
    default:
      return;
  }
}

void Controller::ask_rescan() {
  if (!connections_.rescan) return tell("A new depth scan needs the scans this scene was made from");
  frame_.asks_rescan = true;
  // The dialog shows it.
  toasts_.hide(kRescanQuestion);
  tell(kRescanQuestion);
}

void Controller::go_to_scans() {
  if (connections_.orienting.unavailable) frame_.why_not_orient = connections_.orienting.unavailable();
  if (!frame_.why_not_orient.empty()) return tell("The scans cannot be shown: " + frame_.why_not_orient);
  to_scans_ = true;
}

void Controller::answer(bool yes) {
  boxes_.clear();
  if (!std::exchange(frame_.asks_rescan, false) || !yes || !scene_) return;
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.topLeftCorner<3, 3>() = frame_.camera.axes().transpose();
  // New grid frame: the camera's axes; about the scan frame's origin, so that the turn alone counts.
  const Eigen::Matrix4d grid_from_scan = scene_->description().config.orientation.scan_to_grid;
  orbit_.reset();
  connections_.rescan(turn * grid_from_scan);
}

// The first view: the whole scene, straight on.
void Controller::go_home() {
  orbit_.reset();
  hand_.forget_aim();
  if (scene_) wishes_.act(Action::whole_scene, frame_.state, window());
}

void Controller::welcome_next(const ViewSettings& first) {
  release(drag_key_);
  if (grip_ == Grip::mark) marking_.release();
  grip_ = Grip::none;  // and what it held is not clicked
  turned_px_.setZero();
  hand_.press(false);
  while (marking_.escape()) {
  }
  frame_.looks = !frame_.has_pointer;
  frame_.asks_rescan = false;
  frame_.focused = -1;
  boxes_.clear();
  light_preset_ = 0;
  frame_.settings = first;
  wishes_.welcome_next();
  go_home();
}

// The pointer's hand, moved by keys.
bool Controller::step_hand(Action action) {
  switch (action) {
    case Action::hand_left:
      hand_.step(-kHandStep_m, 0.0);
      return true;
    case Action::hand_right:
      hand_.step(kHandStep_m, 0.0);
      return true;
    case Action::hand_up:
      hand_.step(0.0, kHandStep_m);
      return true;
    case Action::hand_down:
      hand_.step(0.0, -kHandStep_m);
      return true;
    case Action::hand_raise:
      hand_.raise(1.0);
      return true;
    case Action::hand_lower:
      hand_.raise(-1.0);
      return true;
    case Action::press:
      hand_.press(!hand_.presses());
      return true;
    case Action::mode:
      if (!frame_.has_pointer) return true;
      frame_.looks = !frame_.looks;
      hand_.press(false);
      tell(frame_.looks ? "Look: the left button turns the picture" : "Touch: the mouse is the hand");
      return true;
    default:
      return false;
  }
}

bool Controller::set_light(Action action) {
  auto& light = frame_.settings.light;
  switch (action) {
    case Action::light_turn:
      light.azimuth_rad -= kLightStep_rad;
      return true;
    case Action::light_back:
      light.azimuth_rad += kLightStep_rad;
      return true;
    case Action::light_higher:
      light.elevation_rad = std::min(light.elevation_rad + 0.08, 1.4);
      return true;
    case Action::light_lower:
      light.elevation_rad = std::max(light.elevation_rad - 0.08, 0.12);
      return true;
    case Action::light_preset: {
      light_preset_ = (light_preset_ + 1) % static_cast<int>(kLights.size());
      const LightPreset& preset = kLights[static_cast<std::size_t>(light_preset_)];
      light = preset.light;
      tell(fmt::format("Light: {}", preset.name));
      return true;
    }
    default:
      return false;
  }
}

bool Controller::move_camera(Action action) {
  constexpr double kTurn_rad = 0.08, kTilt_rad = 0.06;
  switch (action) {
    case Action::turn_left:
      orbit_.turn(-kTurn_rad, 0.0);
      return true;
    case Action::turn_right:
      orbit_.turn(kTurn_rad, 0.0);
      return true;
    case Action::tilt_up:
      orbit_.turn(0.0, -kTilt_rad);
      return true;
    case Action::tilt_down:
      orbit_.turn(0.0, kTilt_rad);
      return true;
    case Action::closer:
      orbit_.zoom(kCloser);
      return true;
    case Action::farther:
      orbit_.zoom(1.0 / kCloser);
      return true;
    case Action::camera_reset:
      orbit_.reset();
      return true;
    case Action::orthographic:
      orbit_.set_parallel(!orbit_.parallel());
      marking_.set_parallel(orbit_.parallel());
      return true;
    default:
      return false;
  }
}

bool Controller::set_marks(Action action) {
  if (!scene_) return false;
  const haptics::State& state = frame_.state;
  std::optional<Eigen::Vector3d> touched_m;
  if (state.tick != 0 && state.contact != 0)
    touched_m = Eigen::Vector3d(state.proxy_m[0], state.proxy_m[1], state.proxy_m[2]);
  const Window reached = window();
  if (action == Action::add_part) frame_.settings.parts = true;
  if (action == Action::measure_save && !frame_.marks.notes.measures.empty()) screenshot_ = true;
  return marking_.act(action, aim(), touched_m, reached.centre_m, reached.width_m, frame_.settings.parts);
}

// Escape closes what is open and stops a depth scan; with nothing of that it leaves, but not an exhibition, and not
// just after a scene has come: it was to stop the depth scan.
void Controller::close_or_leave() {
  ViewSettings& settings = frame_.settings;
  if (settings.help || frame_.focused >= 0 || frame_.asks_rescan) {
    settings.help = frame_.asks_rescan = false;
    boxes_.clear();
    frame_.focused = -1;
  } else if (!marking_.escape() && !settings.kiosk) {
    const Orienting& scans = connections_.orienting;
    const bool busy = scans.status && scans.cancel && scans.status().busy;
    if (busy) return scans.cancel();
    if (!came_ && frame_.time_s - came_s_ >= kLateStop_s) leave();
  }
}

void Controller::leave() {
  wishes_.quit();
  leave_ = true;
}

}  // namespace sparsha::viewer
