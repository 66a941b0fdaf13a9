// Computes one frame: reads the State, and sets camera, hand and words.
#include "viewer/controller/controller.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "scene/area/regions.h"
#include "scene/frame/workspace.h"
#include "scene/scene.h"
#include "scene/title.h"

namespace sparsha::viewer {
Controller::Controller(const Connections& connections, const ViewSettings& settings)
    : connections_(connections),
      wishes_(connections.requests),
      marking_([this](const std::string& words, haptics::Announcement::Priority priority) { tell(words, priority); },
               connections.save_parts) {
  hand_.touch_object([this](const Eigen::Vector2d& device_m) {
    return connections_.object_before_m ? connections_.object_before_m(device_m) : std::nan("");
  });
  frame_.settings = settings;
  frame_.can_rescan = static_cast<bool>(connections_.rescan);
  frame_.has_pointer = connections_.pointer != nullptr;
  frame_.looks = !frame_.has_pointer;
  frame_.other_scenes = static_cast<bool>(connections_.next_scene);
}

Controller::~Controller() { release(drag_key_); }

void Controller::set_scene(scene::ScenePointer scene) {
  scene_ = std::move(scene);
  came_ = true;
  stage_ = stage_of(scene_->description());
  frame_.title = scene::title_of(scene_->description(), scene_->folder());
  frame_.has_texture = scene_->description().has_envelope;
  frame_.has_friction = scene_->description().config.friction.has_value();
  frame_.why_not_orient = connections_.orienting.unavailable ? connections_.orienting.unavailable()
                                                             : "this scene was opened without its scans";
  orbit_.set_whole(is_whole(scene_->description()));
  orbit_.jump();
  wishes_.forget_windows();
  marking_.set_scene(scene_);
  if (!frame_.settings.kiosk) orbit_.set_parallel(marking_.marks().notes.parallel);
}

// What is spoken comes back by way of the board and is shown then.
void Controller::tell(const std::string& text, haptics::Announcement::Priority priority) {
  if (connections_.speak) connections_.speak(text);
  if (!connections_.speak || connections_.announcements == nullptr) toasts_.tell(text, priority);
}

double Controller::reach_m() const {
  const haptics::State& state = frame_.state;
  return 0.5 * (state.tick != 0 ? state.workspace_m : scene::kDeskWorkspace_m);
}

// Never wider than the scene: a window that reaches beyond it is drawn as the whole of it.
Window Controller::window() const {
  const Window window = window_of(frame_.state, scene_->description());
  const Window whole = window_of({}, scene_->description());
  return window.width_m > whole.width_m ? whole : window;
}

// From places spread over the window; the middle height is the mean of the lowest and the highest of them.
Ground Controller::ground(const Window& window, const HeightAt& height_at) const {
  constexpr int kPlaces = 9;
  Ground ground;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int j = 0; j < kPlaces; ++j)
    for (int i = 0; i < kPlaces; ++i) {
      const double u = static_cast<double>(i) / (kPlaces - 1) - 0.5, v = static_cast<double>(j) / (kPlaces - 1) - 0.5;
      const double z = height_at(window.centre_m.x() + u * window.width_m, window.centre_m.y() + v * window.width_m);
      if (!std::isfinite(z)) continue;
      low = std::min(low, z);
      high = std::max(high, z);
    }
  const double span_m = high - low;
  if (!(span_m >= 0.0) || span_m > 10.0 * stage_.unit_m) return {window.centre_m.z(), window.centre_m.z()};
  ground.middle_m = 0.5 * (low + high);
  ground.high_m = high;
  return ground;
}

void Controller::update(double time_s, const haptics::State& state, int width, int height, const HeightAt& height_at,
                        const HeightAt& drawn_at) {
  const double seconds = std::clamp(time_s - frame_.time_s, 0.0, 0.1);
  frame_.time_s = time_s;
  if (std::exchange(came_, false)) came_s_ = time_s;
  frame_.state = state;
  frame_.mouse = mouse_;
  frame_.strip.add(state);
  drawn_at_ = drawn_at ? drawn_at : height_at;
  if (frame_.marks.version != marking_.marks().version) frame_.marks = marking_.marks();
  frame_.hovered = -1;
  for (std::size_t k = 0; k < boxes_.size(); ++k)
    if (boxes_[k].rect.contains(mouse_.x(), mouse_.y())) frame_.hovered = static_cast<int>(k);
  if (!scene_) return;
  stage_ = stage_of(scene_->description(), state);
  const scene::PartConfig* part = state.tick != 0 ? scene::part_at(scene_->description(), state.place_m) : nullptr;
  const std::string said = part == nullptr ? std::string() : part->say.empty() ? part->name : part->say;
  frame_.part = state.contact != 0 ? said : std::string();
  frame_.toasts = toasts_.update(time_s, connections_.announcements, [&](const haptics::Announcement& announcement) {
    using Place = haptics::Announcement::Place;
    if (announcement.place == Place::part) return announcement.text == said;
    return (state.flags & (announcement.place == Place::edge ? haptics::kFlagOutside : haptics::kFlagUnknownArea)) != 0;
  });
  const Window now = window();
  wishes_.update(time_s, state, now);
  if (overview_waits_) go_to_overview(mouse_);
  turn_object();
  orbit_.update(seconds, now, ground(now, drawn_at ? drawn_at : height_at), stage_,
                layout_of(width, height, frame_.settings).detail, frame_.camera);
  if (connections_.pointer != nullptr)
    connections_.pointer->publish(hand_.update(seconds, state, scene_->description(), stage_, reach_m(), height_at));
}

}  // namespace sparsha::viewer
