#include "haptics/session/navigator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "scene/regions.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

// Tiles are renewed when the proxy is closer to the window's border than this share of its nodes.
constexpr double kFollowShare = 0.08;
// The bubble technique (Dominjon et al. 2005): position control inside, rate control in the rim.
constexpr double kBubble = 0.42;        // half-width of the inside, in workspace widths
constexpr double kFastestScroll = 0.5;  // workspace widths a second, at the very edge
constexpr double kScrollStep = 0.05;    // changes smaller than this share of the fastest are not sent

Eigen::Vector2d across(const std::array<double, 3>& v) { return {v[0], v[1]}; }

/// Whether a part is surely at a place of the grid: of an object that was turned, the middle of the part is.
bool lies_in(const scene::SceneDescription& scene, std::size_t part, const scene::PartPlace& place,
             const Eigen::Vector2d& at_m) {
  if (!scene.region_from_grid) return scene::area_of(scene, part).holds(at_m.x(), at_m.y());
  const double width_m = std::min(place.box_m[2] - place.box_m[0], place.box_m[3] - place.box_m[1]);
  return (at_m - place.middle_m).norm() <= 0.25 * width_m;
}

}  // namespace

CentreRange centre_range(const scene::SceneDescription& scene, const scene::Lattice& level, double width_m) {
  const Eigen::Vector3d half_m(0.5 * width_m, 0.5 * width_m, kBubble * width_m);
  return {Eigen::Vector3d(level.x_m(0), level.y_m(0), scene.height_min_m) + half_m,
          Eigen::Vector3d(level.x_m(level.nx - 1), level.y_m(level.ny - 1), scene.height_max_m) - half_m};
}

Navigator::Navigator(scene::ScenePointer scene, double workspace_width_m, const Effects& effects, Announcer& announcer)
    : scene_(std::move(scene)),
      workspace_width_m_(workspace_width_m),
      effects_(effects),
      announcer_(announcer),
      plan_(first_plan()) {}

const scene::Lattice& Navigator::level(int index) const {
  return scene_->description().levels.at(static_cast<std::size_t>(index));
}

WindowPlan Navigator::plan_at(const ZoomStep& step, const Eigen::Vector2d& centre_m) const {
  WindowPlan plan = plan_window(scene_->description(), step, centre_m, workspace_width_m_);
  plan.effects = effects_;
  return plan;
}

WindowPlan Navigator::first_plan() const {
  const ZoomStep overview = zoom_steps(scene_->description(), workspace_width_m_).front();
  return plan_at(overview, middle_of(level(overview.level)));
}

WindowLoader::Job Navigator::job(const WindowPlan& plan) const {
  WindowLoader::Job result;
  result.scene = scene_;
  result.plan = plan;
  result.command.kind = Command::Kind::swap;
  return result;
}

std::optional<WindowLoader::Job> Navigator::zoom(Zoom direction, const State& state) {
  const std::vector<ZoomStep> steps = zoom_steps(scene_->description(), workspace_width_m_);
  const auto here = std::find_if(steps.begin(), steps.end(), [this](const ZoomStep& step) {
    return step.level == plan_.level && step.nodes == plan_.nodes;
  });
  if (here == steps.end()) return std::nullopt;
  if (direction == Zoom::in && here + 1 == steps.end()) {
    announcer_.say("already_closest");
    return std::nullopt;
  }
  if (direction == Zoom::out && here == steps.begin()) {
    announcer_.say("already_whole");
    return std::nullopt;
  }
  const ZoomStep& next = direction == Zoom::in ? *(here + 1) : *(here - 1);
  // Where the centre will be when the point under the proxy stays under the hand.
  const Eigen::Vector2d point = across(state.proxy_m);
  const Eigen::Vector2d device = (point - across(state.centre_m)) * state.scale;
  const double scale = plan_at(next, point).scale;
  const WindowPlan plan = plan_at(next, point - device / scale);
  announcer_.say_view(view_of(plan, direction == Zoom::in ? View::Kind::closer : View::Kind::farther));
  return job(plan);
}

WindowLoader::Job Navigator::move(Eigen::Vector2d centre_m) {
  const scene::Lattice& lattice = level(plan_.level);
  centre_m.x() = std::clamp(centre_m.x(), lattice.x_m(0), lattice.x_m(lattice.nx - 1));
  centre_m.y() = std::clamp(centre_m.y(), lattice.y_m(0), lattice.y_m(lattice.ny - 1));
  return move(plan_at({plan_.level, plan_.nodes}, centre_m), centre_m);
}

WindowLoader::Job Navigator::move(const WindowPlan& plan, const Eigen::Vector2d& centre_m) {
  goal_m_ = centre_m;
  WindowLoader::Job result = job(plan);
  result.command.move = true;
  result.command.centre_m = centre_m;
  return result;
}

View Navigator::view_of(const WindowPlan& plan, View::Kind between) const {
  const std::vector<ZoomStep> steps = zoom_steps(scene_->description(), workspace_width_m_);
  const auto is = [&plan](const ZoomStep& step) { return step.level == plan.level && step.nodes == plan.nodes; };
  const View::Kind kind = is(steps.front()) ? View::Kind::whole : is(steps.back()) ? View::Kind::closest : between;
  return {kind, workspace_width_m_ / plan.scale, plan.scale};
}

WindowLoader::Job Navigator::whole_scene() {
  const WindowPlan plan = first_plan();
  return move(plan, middle_of(level(plan.level)));
}

Eigen::Vector2d Navigator::hand_m(const State& state) const {
  return goal_m_ ? Eigen::Vector2d(*goal_m_ + across(state.device_m) / plan_.scale) : across(state.hip_m);
}

// To the nearest view that shows the whole part. The window brings the part to the device's centre: said is the way
// that the hand has from where it is to there.
std::optional<WindowLoader::Job> Navigator::part(int step, const State& state) {
  constexpr double kRoom = 1.1;  // window widths a part
  const auto& parts = scene_->description().config.parts;
  if (parts.empty()) {
    announcer_.say("no_parts");
    return std::nullopt;
  }
  const std::size_t count = parts.size();
  part_ = step > 0 ? part_ % count + 1 : (part_ + count - 2) % count + 1;
  const scene::PartConfig& part = parts[part_ - 1];
  const std::optional<scene::PartPlace> place = scene::part_place(*scene_, part_ - 1);
  if (!place) {
    announcer_.say("part_other_side", {{"part", part.say}});
    return std::nullopt;
  }
  const auto& box_m = place->box_m;
  const Eigen::Vector2d centre_m = place->middle_m;
  // Where it lies aside from the box's middle, the window is larger by as much.
  const double aside_x_m = std::abs(centre_m.x() - 0.5 * (box_m[0] + box_m[2]));
  const double aside_y_m = std::abs(centre_m.y() - 0.5 * (box_m[1] + box_m[3]));
  const double size_m = std::max(box_m[2] - box_m[0] + 2.0 * aside_x_m, box_m[3] - box_m[1] + 2.0 * aside_y_m);
  WindowPlan plan = first_plan();
  for (const ZoomStep& nearer : zoom_steps(scene_->description(), workspace_width_m_))
    if (const WindowPlan next = plan_at(nearer, centre_m); workspace_width_m_ / next.scale >= kRoom * size_m)
      plan = next;
  const Eigen::Vector2d way_m = -across(state.device_m);
  const Eigen::Vector2d hand_m = centre_m - way_m / plan.scale;
  announcer_.say_part(part_ - 1, way_m, lies_in(scene_->description(), part_ - 1, *place, hand_m));
  return move(plan, centre_m);
}

std::optional<WindowLoader::Job> Navigator::wish(const Request& request, const State& state) {
  const Eigen::Vector2d centre_m = across(state.centre_m);
  const auto finite = [&] { return std::isfinite(request.x) && std::isfinite(request.y); };
  switch (request.kind) {
    case Request::Kind::zoom_in:
      return zoom(Zoom::in, state);
    case Request::Kind::zoom_out:
      return zoom(Zoom::out, state);
    case Request::Kind::whole_scene: {
      WindowLoader::Job overview = whole_scene();
      announcer_.say_view(view_of(overview.plan));
      return overview;
    }
    case Request::Kind::next_part:
      return part(+1, state);
    case Request::Kind::previous_part:
      return part(-1, state);
    case Request::Kind::pan:
      if (!finite()) return std::nullopt;
      // Several keys may come before the servo has answered the first.
      return move(goal_m_.value_or(centre_m) + Eigen::Vector2d(request.x, request.y) * width_m());
    case Request::Kind::move_to:
      if (!finite()) return std::nullopt;
      return move({request.x, request.y});
    case Request::Kind::scroll:
      if (finite()) asked_ = {request.x, request.y};
      return std::nullopt;
    case Request::Kind::set_texture:
    case Request::Kind::set_friction: {
      const bool texture = request.kind == Request::Kind::set_texture;
      bool& present = texture ? effects_.texture : effects_.friction;
      if (present == request.on) return std::nullopt;
      present = request.on;
      if (texture)
        announcer_.say(request.on ? Phrase("texture_on") : Phrase("texture_off"));
      else
        announcer_.say(request.on ? Phrase("friction_on") : Phrase("friction_off"));
      WindowPlan plan = plan_;
      plan.effects = effects_;
      return job(plan);
    }
    case Request::Kind::turn:
    case Request::Kind::turn_back:
      announcer_.say("turn_one_view");
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

WindowLoader::Job Navigator::change_scene(scene::ScenePointer scene) {
  const bool only_labels = scene::same_ground(scene_->description(), scene->description());
  scene_ = std::move(scene);
  announcer_.set_scene(scene_);
  part_ = 0;
  return only_labels ? job(plan_) : whole_scene();
}

std::optional<WindowLoader::Job> Navigator::follow(const State& state) const {
  const scene::Lattice& lattice = level(plan_.level);
  const Eigen::Vector2d node = (across(state.proxy_m) - lattice.origin_m.head<2>()) / lattice.spacing_m;
  // A border counts only when the level goes on beyond it.
  const auto near_border = [](double at, int first, int count, int level_count) {
    const double margin = std::max(2.0, kFollowShare * count);
    return (at < first + margin && first > 0) || (at > first + count - 1 - margin && first + count < level_count);
  };
  if (!near_border(node.x(), plan_.i0, plan_.nx, lattice.nx) && !near_border(node.y(), plan_.j0, plan_.ny, lattice.ny))
    return std::nullopt;
  const WindowPlan plan = plan_at({plan_.level, plan_.nodes}, across(state.proxy_m));
  if (plan.i0 == plan_.i0 && plan.j0 == plan_.j0) return std::nullopt;
  return job(plan);
}

std::optional<Command> Navigator::scroll(const State& state) {
  const double width = workspace_width_m_ / state.scale;  // of the workspace, grid frame
  // The centre goes no further than brings the scene's edges to the workspace's, its highest and lowest points in
  // reach.
  const auto [low, high] = centre_range(scene_->description(), level(plan_.level), width);
  const double fastest = kFastestScroll * width;
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double place = state.device_m[static_cast<std::size_t>(axis)] / workspace_width_m_;
    const double depth = std::clamp((std::abs(place) - kBubble) / (0.5 - kBubble), 0.0, 1.0);
    double speed = std::copysign(fastest * depth * depth, place);
    if (axis < 2 && asked_[axis] != 0.0) speed = asked_[axis] * width;
    const double centre = state.centre_m[static_cast<std::size_t>(axis)];
    if ((speed > 0.0 && centre < high[axis]) || (speed < 0.0 && centre > low[axis])) wanted[axis] = speed;
  }
  if (state.contact != 0) wanted.z() = std::max(0.0, wanted.z());
  const bool stops = wanted.isZero(0.0) && !scroll_.isZero(0.0);
  if (!stops && (wanted - scroll_).norm() <= kScrollStep * fastest) return std::nullopt;
  if (scroll_.isZero(0.0)) say_direction(wanted, state.time_s);
  scrolled_s_ = state.time_s;
  scroll_ = wanted;
  Command command;
  command.kind = Command::Kind::scroll;
  command.scroll_m_per_s = wanted;
  return command;
}

// A hand at the rim starts and stops the window time and again.
void Navigator::say_direction(const Eigen::Vector3d& velocity, double time_s) {
  constexpr double kSilence_s = 2.0;
  constexpr std::array<std::array<Phrase, 2>, 3> kWords = {
      {{"moving_left", "moving_right"}, {"moving_down", "moving_up"}, {"going_deeper", "coming_nearer"}}};
  Eigen::Index axis = 0;
  velocity.cwiseAbs().maxCoeff(&axis);
  const Phrase words = kWords[static_cast<std::size_t>(axis)][velocity[axis] > 0.0 ? 1 : 0];
  if (words.index() == direction_.index() && time_s - scrolled_s_ < kSilence_s) return;
  direction_ = words;
  announcer_.say(words);
}

}  // namespace sparsha::haptics
