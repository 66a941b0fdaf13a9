// Keys, buttons and mouse to requests, settings, camera and hand.
#include "viewer/controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "scene/regions.h"
#include "scene/workspace.h"

namespace sparsha::viewer {
namespace {

using haptics::Announcement;
using Kind = haptics::Request::Kind;

constexpr double kHoverM = 0.008;  // above the surface, device frame
constexpr double kPressM = 0.003;
constexpr double kDeepestM = 0.015;
constexpr double kWheelM = 0.0005;     // one notch of the wheel
constexpr double kHandStepM = 0.002;   // one arrow key
constexpr double kHandFollowS = 0.06;  // the hand's height follows so slowly that fine texture is felt
constexpr double kCameraFollowS = 0.09;
constexpr double kLightStepRad = std::numbers::pi / 12.0;

std::string title_of(const pipeline::Scene& scene) {
  std::filesystem::path folder = scene.folder();
  if (folder.filename().empty()) folder = folder.parent_path();
  std::string name = folder.filename().string();
  if (name.empty() || name == "scene") {
    const auto& sources = scene.description().sources;
    if (!sources.empty()) {
      const std::filesystem::path file = sources.front().file;
      // Several scans of one object lie in the object's folder.
      name =
          sources.size() > 1 && file.has_parent_path() ? file.parent_path().filename().string() : file.stem().string();
    }
  }
  std::ranges::replace(name, '_', ' ');
  std::ranges::replace(name, '-', ' ');
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

}  // namespace

Camera camera_for(const Window& window, const Stage& stage, double turn_rad, double tilt_rad, double zoom,
                  const Eigen::Vector2d& shift, const Rect& rect) {
  Camera camera;
  const double width = window.width_m / stage.unit_m;
  const double aspect = static_cast<double>(std::max(rect.width, 1)) / std::max(rect.height, 1);
  camera.turn_rad = turn_rad;
  camera.tilt_rad = tilt_rad;
  camera.field_rad = 0.5;
  camera.target = stage.to_world(window.centre_m) + Eigen::Vector3d(shift.x() * width, shift.y() * width, 0.0);
  const double tangent = std::tan(0.5 * camera.field_rad);
  const double across = 0.5 * width / (tangent * aspect);
  const double upright = 0.5 * width / tangent;
  // A tilted window's near edge comes closer by half its width times the sine.
  camera.distance = (1.10 * std::max(across, upright) + 0.35 * width * std::sin(tilt_rad)) / zoom;
  return camera;
}

Controller::Controller(const Connections& connections, const ViewSettings& settings) : connections_(connections) {
  frame_.settings = settings;
  frame_.can_rescan = static_cast<bool>(connections_.rescan);
  frame_.has_pointer = connections_.pointer != nullptr;
  frame_.other_scenes = static_cast<bool>(connections_.next_scene);
  tilt_rad_ = kStandardTiltRad;
  offset_m_ = kHoverM;
  press_m_ = kPressM;
}

void Controller::set_scene(pipeline::ScenePointer scene) {
  scene_ = std::move(scene);
  stage_ = stage_of(scene_->description());
  frame_.title = title_of(*scene_);
  frame_.why_not_orient = connections_.orienting.unavailable ? connections_.orienting.unavailable()
                                                             : "this scene was opened without its scans";
  first_ = true;
}

void Controller::post(Kind kind, double x, double y, bool on) {
  if (connections_.requests != nullptr) connections_.requests->post({kind, x, y, on});
}

void Controller::tell(const std::string& text, Announcement::Priority priority) {
  own_.push_back({text, priority, 0});
  if (connections_.speak) connections_.speak(text);
}

double Controller::reach_m() const {
  const haptics::State& state = frame_.state;
  return 0.5 * (state.tick != 0 ? state.workspace_m : pipeline::kDeskWorkspaceM);
}

double Controller::step_m() const { return kHandStepM; }

std::vector<Action> Controller::buttons() const {
  std::vector<Action> result;
  for (const ActionInfo& info : all_actions())
    if ((frame_.settings.kiosk ? info.kiosk_button : info.button) &&
        (info.action != Action::next_scene || connections_.next_scene))
      result.push_back(info.action);
  return result;
}

void Controller::move_focus(int step) {
  const std::vector<Action> list = buttons();
  const int count = static_cast<int>(list.size());
  frame_.focused = frame_.focused < 0 ? (step > 0 ? 0 : count - 1) : (frame_.focused + step + count) % count;
  const ActionInfo& info = info_of(list[static_cast<std::size_t>(frame_.focused)]);
  std::string value;
  if (info.action == Action::texture) value = (frame_.state.flags & haptics::kFlagTexture) != 0 ? ", on" : ", off";
  if (info.action == Action::friction) value = (frame_.state.flags & haptics::kFlagFriction) != 0 ? ", on" : ", off";
  if (info.action == Action::colour) value = fmt::format(", {}", name_of(frame_.settings.colour));
  if (connections_.speak) connections_.speak(fmt::format("{}{}: {}", info.label, value, info.what));
}

void Controller::press(const KeyPress& press) {
  if (frame_.asks_rescan && press.key == key::kEnter) {
    frame_.asks_rescan = false;
    Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
    turn.topLeftCorner<3, 3>() = frame_.camera.axes().transpose();
    // New grid frame: the camera's axes; about the scan frame's origin, so that the turn alone counts.
    Eigen::Matrix4d grid_from_scan = scene_->description().config.orientation.scan_to_grid;
    turn_rad_ = 0.0;
    tilt_rad_ = kStandardTiltRad;
    connections_.rescan(turn * grid_from_scan);
    return;
  }
  if (frame_.focused >= 0 && press.key == key::kEnter && !press.repeated) {
    const std::vector<Action> list = buttons();
    act(list[std::min(static_cast<std::size_t>(frame_.focused), list.size() - 1)]);
    return;
  }
  if (const auto action = action_of(press, frame_.settings.kiosk)) act(*action);
}

void Controller::act(Action action) {
  if (ask_session(action) || step_hand(action) || set_light(action) || move_camera(action) || set_view(action)) return;
  switch (action) {
    case Action::rescan:
      if (!connections_.rescan) return tell("A new depth scan needs the scans this scene was made from");
      frame_.asks_rescan = true;
      return tell("Scan again from this side? Enter is yes, Escape is no");
    case Action::orient:
      if (connections_.orienting.unavailable) frame_.why_not_orient = connections_.orienting.unavailable();
      if (!frame_.why_not_orient.empty()) return tell("The scans cannot be shown: " + frame_.why_not_orient);
      to_scans_ = true;
      return;
    case Action::next_scene:
    case Action::previous_scene:
      if (connections_.next_scene) connections_.next_scene(action == Action::next_scene ? 1 : -1);
      return;
    case Action::next_item:
      return move_focus(1);
    case Action::previous_item:
      return move_focus(-1);
    case Action::escape:
      return close_or_leave();
    case Action::quit:
      return leave();
    default:
      return;
  }
}

// What the session does: level, window, effects, words.
bool Controller::ask_session(Action action) {
  const auto off = [&](std::uint64_t bit) { return (frame_.state.flags & bit) == 0; };
  switch (action) {
    case Action::zoom_in:
      post(Kind::zoom_in);
      return true;
    case Action::zoom_out:
      post(Kind::zoom_out);
      return true;
    case Action::next_part:
      post(Kind::next_part);
      return true;
    case Action::previous_part:
      post(Kind::previous_part);
      return true;
    case Action::whole_scene:
      post(Kind::whole_scene);
      return true;
    case Action::tour:
      post(Kind::tour);
      return true;
    case Action::pan_left:
      post(Kind::pan, -0.25, 0.0);
      return true;
    case Action::pan_right:
      post(Kind::pan, 0.25, 0.0);
      return true;
    case Action::pan_up:
      post(Kind::pan, 0.0, 0.25);
      return true;
    case Action::pan_down:
      post(Kind::pan, 0.0, -0.25);
      return true;
    case Action::texture:
      post(Kind::set_texture, 0.0, 0.0, off(haptics::kFlagTexture));
      return true;
    case Action::friction:
      post(Kind::set_friction, 0.0, 0.0, off(haptics::kFlagFriction));
      return true;
    case Action::stiffer:
      post(Kind::scale_stiffness, 1.25);
      return true;
    case Action::softer:
      post(Kind::scale_stiffness, 0.8);
      return true;
    case Action::describe:
      post(Kind::describe);
      return true;
    default:
      return false;
  }
}

// The pointer's hand, moved by keys.
bool Controller::step_hand(Action action) {
  switch (action) {
    case Action::hand_left:
      hand_m_.x() -= step_m();
      break;
    case Action::hand_right:
      hand_m_.x() += step_m();
      break;
    case Action::hand_up:
      hand_m_.y() += step_m();
      break;
    case Action::hand_down:
      hand_m_.y() -= step_m();
      break;
    case Action::hand_raise:
      offset_m_ = std::min(offset_m_ + kWheelM, 2.0 * kHoverM);
      break;
    case Action::hand_lower:
      offset_m_ = std::max(offset_m_ - kWheelM, -kDeepestM);
      break;
    case Action::press:
      pressed_ = !pressed_;
      break;
    default:
      return false;
  }
  hand_m_ = hand_m_.cwiseMax(-reach_m()).cwiseMin(reach_m());
  return true;
}

bool Controller::set_light(Action action) {
  auto& light = frame_.settings.light;
  switch (action) {
    case Action::light_turn:
      light.azimuth_rad -= kLightStepRad;
      return true;
    case Action::light_back:
      light.azimuth_rad += kLightStepRad;
      return true;
    case Action::light_higher:
      light.elevation_rad = std::min(light.elevation_rad + 0.08, 1.4);
      return true;
    case Action::light_lower:
      light.elevation_rad = std::max(light.elevation_rad - 0.08, 0.12);
      return true;
    default:
      return false;
  }
}

bool Controller::move_camera(Action action) {
  switch (action) {
    case Action::turn_left:
      turn_rad_ -= 0.08;
      return true;
    case Action::turn_right:
      turn_rad_ += 0.08;
      return true;
    case Action::tilt_up:
      tilt_rad_ = std::max(tilt_rad_ - 0.06, 0.0);
      return true;
    case Action::tilt_down:
      tilt_rad_ = std::min(tilt_rad_ + 0.06, 1.65);
      return true;
    case Action::closer:
      zoom_ = std::min(zoom_ * 1.15, 20.0);
      return true;
    case Action::farther:
      zoom_ = std::max(zoom_ / 1.15, 0.1);
      return true;
    case Action::camera_reset:
      turn_rad_ = 0.0;
      tilt_rad_ = kStandardTiltRad;
      zoom_ = 1.0;
      shift_.setZero();
      return true;
    default:
      return false;
  }
}

// What is drawn, and how.
bool Controller::set_view(Action action) {
  ViewSettings& settings = frame_.settings;
  const auto turn = [&](const char* what, bool& setting) {
    setting = !setting;
    tell(fmt::format("{} {}", what, setting ? "on" : "off"));
  };
  switch (action) {
    case Action::colour:
      if (!scene_) return true;
      settings.colour = next_mode(scene_->description(), settings.colour);
      tell(fmt::format("Colour: {}", name_of(settings.colour)));
      return true;
    case Action::stereo:
      next_stereo();
      return true;
    case Action::filled:
      turn("Marks on filled areas", settings.mark_filled);
      return true;
    case Action::contrast:
      turn("High contrast", settings.high_contrast);
      return true;
    case Action::large_type:
      turn("Large type", settings.large_type);
      return true;
    case Action::help:
      settings.help = !settings.help;
      return true;
    default:
      return false;
  }
}

// Off, grey, coloured, off.
void Controller::next_stereo() {
  ViewSettings& settings = frame_.settings;
  if (!settings.anaglyph) {
    settings.anaglyph = settings.anaglyph_grey = true;
  } else if (settings.anaglyph_grey) {
    settings.anaglyph_grey = false;
  } else {
    settings.anaglyph = false;
  }
  tell(!settings.anaglyph       ? "Stereo off"
       : settings.anaglyph_grey ? "Stereo: red and cyan, grey"
                                : "Stereo: red and cyan, colours");
}

// Escape closes what is open; with nothing open it leaves, but not an exhibition.
void Controller::close_or_leave() {
  ViewSettings& settings = frame_.settings;
  if (settings.help || frame_.focused >= 0 || frame_.asks_rescan) {
    settings.help = frame_.asks_rescan = false;
    frame_.focused = -1;
  } else if (!settings.kiosk) {
    leave();
  }
}

void Controller::leave() {
  post(Kind::quit);
  leave_ = true;
}

void Controller::mouse_move(double x, double y, const Layout& layout, const View& view, const Stage& stage,
                            const HeightAt& height) {
  const Eigen::Vector2d now(x, y);
  const Eigen::Vector2d moved = now - mouse_;
  mouse_ = now;
  const bool orbits = right_down_ || (left_down_ && !frame_.has_pointer);
  if (orbits) {
    turn_rad_ -= 0.006 * moved.x();
    tilt_rad_ = std::clamp(tilt_rad_ - 0.006 * moved.y(), 0.0, 1.65);
    return;
  }
  if (middle_down_) {
    const double share = 1.0 / std::max(view.pixels_per_unit(view.focus), 1e-9);
    const Window window = window_of(frame_.state, scene_->description());
    const double width = window.width_m / stage.unit_m;
    const Eigen::Vector2d turned(std::cos(turn_rad_) * moved.x() + std::sin(turn_rad_) * moved.y(),
                                 std::sin(turn_rad_) * moved.x() - std::cos(turn_rad_) * moved.y());
    shift_ -= turned * share / width;
    return;
  }
  if (!frame_.has_pointer || !layout.detail.contains(x, y) || frame_.state.tick == 0) return;
  // The hand is where the mouse's ray meets the stone; three steps settle it on reliefs.
  const double px = x - layout.detail.x, py = y - layout.detail.y;
  double z_m = frame_.state.centre_m[2];
  for (int step = 0; step < 3; ++step) {
    const double world_z = (z_m - stage.anchor_m.z()) / stage.unit_m;
    const auto hit = view.on_plane(px, py, world_z);
    if (!hit) return;
    const Eigen::Vector3d grid = stage.to_grid_m(*hit);
    hand_m_ =
        frame_.state.scale * Eigen::Vector2d(grid.x() - frame_.state.centre_m[0], grid.y() - frame_.state.centre_m[1]);
    z_m = height(grid.x(), grid.y());
  }
  hand_m_ = hand_m_.cwiseMax(-reach_m()).cwiseMin(reach_m());
}

void Controller::mouse_button(int button, bool down, int /*modifiers*/) {
  if (button == 0) {
    left_down_ = down;
    pressed_ = down;
  } else if (button == 1) {
    right_down_ = down;
  } else if (button == 2) {
    middle_down_ = down;
  }
}

void Controller::mouse_wheel(double steps, int modifiers) {
  const bool camera = !frame_.has_pointer || (modifiers & kControl) != 0 || right_down_;
  if (camera) {
    zoom_ = std::clamp(zoom_ * std::pow(1.12, steps), 0.1, 20.0);
  } else if (pressed_) {
    press_m_ = std::clamp(press_m_ - steps * kWheelM, 0.0, kDeepestM);
  } else {
    offset_m_ = std::clamp(offset_m_ + steps * kWheelM, -kDeepestM, 2.0 * kHoverM);
  }
}

void Controller::take_announcements(double time_s) {
  std::vector<Announcement> fresh;
  if (connections_.announcements != nullptr) {
    fresh = connections_.announcements->since(seen_);
    if (!fresh.empty()) seen_ = fresh.back().sequence;
  }
  fresh.insert(fresh.end(), own_.begin(), own_.end());
  own_.clear();
  for (Announcement& announcement : fresh) {
    double length_s = 2.0 + 0.06 * static_cast<double>(announcement.text.size());
    if (announcement.priority == Announcement::Priority::warning) length_s *= 1.5;
    if (announcement.priority == Announcement::Priority::fault) length_s *= 2.0;
    std::erase_if(shown_, [&](const Shown& shown) { return shown.announcement.text == announcement.text; });
    shown_.push_back({std::move(announcement), time_s + length_s, length_s});
  }
  std::erase_if(shown_, [&](const Shown& shown) { return shown.until_s <= time_s; });
  constexpr std::size_t kMost = 2;
  if (shown_.size() > kMost) shown_.erase(shown_.begin(), shown_.end() - kMost);
  frame_.toasts.clear();
  for (const Shown& shown : shown_)
    frame_.toasts.push_back({shown.announcement, (shown.until_s - time_s) / shown.length_s});
}

void Controller::ease_camera(double seconds, int width, int height) {
  Window window = window_of(frame_.state, scene_->description());
  const Window whole = window_of({}, scene_->description());
  if (window.width_m > whole.width_m) window = whole;
  const Layout layout = layout_of(width, height, frame_.settings);
  const Camera goal = camera_for(window, stage_, turn_rad_, tilt_rad_, zoom_, shift_, layout.detail);
  Camera& now = frame_.camera;
  const double share = first_ ? 1.0 : 1.0 - std::exp(-seconds / kCameraFollowS);
  const bool near = (goal.target - now.target).norm() < 2e-4 * goal.distance &&
                    std::abs(goal.distance - now.distance) < 2e-4 * goal.distance &&
                    std::abs(goal.turn_rad - now.turn_rad) < 2e-4 && std::abs(goal.tilt_rad - now.tilt_rad) < 2e-4;
  if (first_ || near) {
    now = goal;
  } else {
    now.target += share * (goal.target - now.target);
    now.distance *= std::pow(goal.distance / now.distance, share);
    now.turn_rad += share * (goal.turn_rad - now.turn_rad);
    now.tilt_rad += share * (goal.tilt_rad - now.tilt_rad);
    now.field_rad = goal.field_rad;
  }
  first_ = false;
}

void Controller::move_hand(double seconds, const HeightAt& height_at) {
  const haptics::State& state = frame_.state;
  if (connections_.pointer == nullptr) return;
  double surface_m = 0.0;
  if (state.tick != 0 && state.scale > 0.0) {
    const double x_m = state.centre_m[0] + hand_m_.x() / state.scale;
    const double y_m = state.centre_m[1] + hand_m_.y() / state.scale;
    surface_m = state.scale * (height_at(x_m, y_m) - state.centre_m[2]);
    if (!std::isfinite(surface_m)) surface_m = 0.0;
  }
  const double goal_m = std::clamp(surface_m + (pressed_ ? -press_m_ : offset_m_), -reach_m(), reach_m());
  hand_z_m_ = hand_known_ ? hand_z_m_ + (1.0 - std::exp(-seconds / kHandFollowS)) * (goal_m - hand_z_m_) : goal_m;
  hand_known_ = true;
  haptics::PointerSample sample;
  sample.device_m = {hand_m_.x(), hand_m_.y(), hand_z_m_};
  sample.sequence = ++sequence_;
  connections_.pointer->publish(sample);
}

void Controller::update(double time_s, const haptics::State& state, int width, int height, const HeightAt& height_at) {
  const double seconds = std::clamp(time_s - frame_.time_s, 0.0, 0.1);
  frame_.time_s = time_s;
  frame_.state = state;
  if (!scene_) return;
  frame_.part.clear();
  if (state.tick != 0 && state.contact != 0) {
    const pipeline::PartConfig* part = pipeline::part_at(scene_->description(), state.place_m);
    if (part != nullptr) frame_.part = part->say.empty() ? part->name : part->say;
  }
  take_announcements(time_s);
  ease_camera(seconds, width, height);
  move_hand(seconds, height_at);
}

}  // namespace sparsha::viewer
