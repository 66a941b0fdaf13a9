#include "haptics/session/navigator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "haptics/around/object_surface.h"
#include "haptics/state/vectors.h"
#include "scene/area/regions.h"
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

Eigen::Quaterniond turn_of(const State& state) { return {state.turn[3], state.turn[0], state.turn[1], state.turn[2]}; }

Command turn_command(const Eigen::Quaterniond& turn) {
  Command command;
  command.kind = Command::Kind::turn;
  command.turn = turn;
  return command;
}

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

AroundView around_view(const Eigen::AlignedBox3d& box_m, const State& state, double width_m) {
  const Eigen::Matrix3d device_from_grid = turn_of(state).toRotationMatrix();
  AroundView view;
  view.centre_m = device_from_grid * (to_vector(state.centre_m) - box_m.center());
  view.box_half_m = device_from_grid.cwiseAbs() * (0.5 * box_m.sizes());
  const Eigen::Vector3d window_half_m(0.5 * width_m, 0.5 * width_m, kBubble * width_m);
  view.range.high_m = (view.box_half_m - window_half_m).cwiseMax(0.0);
  view.range.low_m = -view.range.high_m;
  return view;
}

Navigator::Navigator(scene::ScenePointer scene, double workspace_width_m, const Effects& effects, Announcer& announcer)
    : scene_(std::move(scene)),
      workspace_width_m_(workspace_width_m),
      effects_(effects),
      announcer_(announcer),
      plan_(first_plan()) {
  know_object();
}

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
  goal_m_ = Eigen::Vector3d(centre_m.x(), centre_m.y(), 0.0);
  WindowLoader::Job result = job(plan);
  result.command.move = true;
  result.command.centre_m = centre_m;
  return result;
}

void Navigator::know_object() {
  const scene::SceneDescription& scene = scene_->description();
  box_m_.reset();
  if (!touches_all_around(scene)) return;
  Eigen::AlignedBox3d box = box_of(*scene.charts);
  box.translate(scene.charts->origin_m);
  box_m_ = box;
}

WindowLoader::Job Navigator::move_object(const Eigen::Vector3d& centre_m) {
  const Eigen::Vector3d within_m = centre_m.cwiseMax(box_m_->min()).cwiseMin(box_m_->max());
  return move_object(plan_at({plan_.level, plan_.nodes}, within_m.head<2>()), within_m);
}

WindowLoader::Job Navigator::move_object(const WindowPlan& plan, const Eigen::Vector3d& centre_m) {
  WindowLoader::Job result = move(plan, centre_m.head<2>());
  goal_m_ = centre_m;
  result.command.centre_z_m = centre_m.z();
  return result;
}

// Across the view as the object is turned now, or to a place of the grid at the depth of the present one.
std::optional<WindowLoader::Job> Navigator::wish_for_object(const Request& request, const State& state) {
  const Eigen::Vector3d from_m = goal_m_.value_or(to_vector(state.centre_m));
  if (request.kind == Request::Kind::move_to) return move_object({request.x, request.y, from_m.z()});
  const Eigen::Vector3d way_m = turn_of(state).conjugate() * Eigen::Vector3d(request.x, request.y, 0.0) * width_m();
  return move_object(from_m + way_m);
}

std::optional<Command> Navigator::turn(const Request& request) {
  constexpr double kMost_deg = 360.0;
  constexpr double kRadians = 3.14159265358979323846 / 180.0;
  if (!box_m_) {
    announcer_.say("turn_one_view");
    return std::nullopt;
  }
  const Eigen::Quaterniond before = turn_;
  const Eigen::Vector3d way_deg(request.x, request.y, request.z);
  if (request.kind == Request::Kind::turn_back) {
    turn_.setIdentity();
  } else {
    const double angle_deg = way_deg.norm();
    if (!(angle_deg > 0.0 && angle_deg <= kMost_deg)) return std::nullopt;
    turn_ = Eigen::AngleAxisd(kRadians * angle_deg, way_deg / angle_deg) * turn_;
    turn_.normalize();
  }
  announcer_.say_turned(turn_, request.on ? &before : nullptr);
  return turn_command(turn_);
}

std::optional<Command> Navigator::face_front() {
  if (!box_m_ || turn_.coeffs() == Eigen::Quaterniond::Identity().coeffs()) return std::nullopt;
  turn_.setIdentity();
  return turn_command(turn_);
}

View Navigator::view_of(const WindowPlan& plan, View::Kind between) const {
  const std::vector<ZoomStep> steps = zoom_steps(scene_->description(), workspace_width_m_);
  const auto is = [&plan](const ZoomStep& step) { return step.level == plan.level && step.nodes == plan.nodes; };
  const View::Kind kind = is(steps.front()) ? View::Kind::whole : is(steps.back()) ? View::Kind::closest : between;
  return {kind, workspace_width_m_ / plan.scale, plan.scale};
}

WindowLoader::Job Navigator::whole_scene() {
  const WindowPlan plan = first_plan();
  if (box_m_) return move_object(plan, box_m_->center());
  return move(plan, middle_of(level(plan.level)));
}

Eigen::Vector3d Navigator::hand_m(const State& state) const {
  if (!goal_m_) return to_vector(state.hip_m);
  return *goal_m_ + turn_.conjugate() * to_vector(state.device_m) / plan_.scale;
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
  const double size_m = place->solid
                            ? place->solid->size_m
                            : std::max(box_m[2] - box_m[0] + 2.0 * aside_x_m, box_m[3] - box_m[1] + 2.0 * aside_y_m);
  WindowPlan plan = first_plan();
  for (const ZoomStep& nearer : zoom_steps(scene_->description(), workspace_width_m_))
    if (const WindowPlan next = plan_at(nearer, centre_m); workspace_width_m_ / next.scale >= kRoom * size_m)
      plan = next;
  const Eigen::Vector2d way_m = -across(state.device_m);
  if (box_m_ && place->solid) return show(plan, *place->solid, way_m);
  const Eigen::Vector2d hand_m = centre_m - way_m / plan.scale;
  announcer_.say_part(part_ - 1, way_m, lies_in(scene_->description(), part_ - 1, *place, hand_m));
  if (box_m_) return move_object(plan, {centre_m.x(), centre_m.y(), state.centre_m[2]});
  return move(plan, centre_m);
}

// The object is turned about the upright until the part looks at the visitor, and then tipped, which keeps up what is
// up; of a part that looks straight up or down it is tipped alone.
WindowLoader::Job Navigator::show(const WindowPlan& plan, const scene::PartPlace::Solid& solid,
                                  const Eigen::Vector2d& way_m) {
  constexpr double kUpright = 0.98;  // of the normal
  const Eigen::Vector3d normal = solid.normal.norm() > 0.0 ? solid.normal.normalized() : Eigen::Vector3d::UnitZ();
  Eigen::Quaterniond round = Eigen::Quaterniond::Identity();
  if (std::abs(normal.y()) < kUpright)
    round = Eigen::AngleAxisd(-std::atan2(normal.x(), normal.z()), Eigen::Vector3d::UnitY());
  const Eigen::Vector3d level = round * normal;
  const double tip = std::atan2(level.y(), level.z());
  turn_ = (Eigen::AngleAxisd(tip, Eigen::Vector3d::UnitX()) * round).normalized();
  announcer_.say_part(part_ - 1, way_m, false);
  WindowLoader::Job result = move_object(plan, solid.middle_m);
  result.command.on = true;
  result.command.turn = turn_;
  return result;
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
      if (box_m_) return wish_for_object(request, state);
      // Several keys may come before the servo has answered the first.
      return move((goal_m_ ? Eigen::Vector2d(goal_m_->head<2>()) : centre_m) +
                  Eigen::Vector2d(request.x, request.y) * width_m());
    case Request::Kind::move_to:
      if (!finite()) return std::nullopt;
      if (box_m_) return wish_for_object(request, state);
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
      const scene::SceneDescription& description = scene_->description();
      if (texture)
        announcer_.say(!description.has_envelope ? Phrase("texture_none")
                       : request.on              ? Phrase("texture_on")
                                                 : Phrase("texture_off"));
      else
        announcer_.say(!description.config.friction ? Phrase("friction_none")
                       : request.on                 ? Phrase("friction_on")
                                                    : Phrase("friction_off"));
      WindowPlan plan = plan_;
      plan.effects = effects_;
      return job(plan);
    }
    default:
      return std::nullopt;
  }
}

WindowLoader::Job Navigator::change_scene(scene::ScenePointer scene) {
  const bool only_labels = scene::same_ground(scene_->description(), scene->description());
  const auto charts = scene_->description().charts;
  scene_ = std::move(scene);
  if (charts != scene_->description().charts) turn_.setIdentity();
  know_object();
  announcer_.set_scene(scene_);
  part_ = 0;
  return only_labels ? job(plan_) : whole_scene();
}

std::optional<WindowLoader::Job> Navigator::follow(const State& state) const {
  if (box_m_) return std::nullopt;  // the whole object is there
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

// What the hand at the workspace's rim asks for, device frame.
Eigen::Vector3d Navigator::rim_speed(const State& state) const {
  const double fastest = kFastestScroll * workspace_width_m_ / state.scale;
  Eigen::Vector3d speed;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = state.device_m[static_cast<std::size_t>(axis)] / workspace_width_m_;
    const double depth = std::clamp((std::abs(place) - kBubble) / (0.5 - kBubble), 0.0, 1.0);
    speed[axis] = std::copysign(fastest * depth * depth, place);
    if (axis < 2 && asked_[axis] != 0.0) speed[axis] = asked_[axis] * workspace_width_m_ / state.scale;
  }
  return speed;
}

Eigen::Vector3d Navigator::scroll_wanted(const State& state) const {
  if (box_m_) return scroll_around(state);
  // The centre goes no further than brings the scene's edges to the workspace's, its highest and lowest points in
  // reach.
  const auto [low, high] = centre_range(scene_->description(), level(plan_.level), workspace_width_m_ / state.scale);
  const Eigen::Vector3d speed = rim_speed(state);
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = state.centre_m[static_cast<std::size_t>(axis)];
    if ((speed[axis] > 0.0 && centre < high[axis]) || (speed[axis] < 0.0 && centre > low[axis]))
      wanted[axis] = speed[axis];
  }
  if (state.contact != 0) wanted.z() = std::max(0.0, wanted.z());
  return wanted;
}

// Likewise along the axes of the device, for a whole object as it is turned.
Eigen::Vector3d Navigator::scroll_around(const State& state) const {
  const AroundView view = around_view(*box_m_, state, workspace_width_m_ / state.scale);
  const Eigen::Vector3d speed = rim_speed(state);
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = view.centre_m[axis];
    if ((speed[axis] > 0.0 && centre < view.range.high_m[axis]) ||
        (speed[axis] < 0.0 && centre > view.range.low_m[axis]))
      wanted[axis] = speed[axis];
  }
  return turn_of(state).conjugate() * wanted;
}

std::optional<Command> Navigator::scroll(const State& state) {
  const Eigen::Vector3d wanted = scroll_wanted(state);
  const double fastest = kFastestScroll * workspace_width_m_ / state.scale;
  const bool stops = wanted.isZero(0.0) && !scroll_.isZero(0.0);
  if (!stops && (wanted - scroll_).norm() <= kScrollStep * fastest) return std::nullopt;
  if (scroll_.isZero(0.0)) say_direction(turn_of(state) * wanted, state.time_s);
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
