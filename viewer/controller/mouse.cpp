// The mouse: the hand over the stone, the camera, the light, the overview and what can be clicked.
#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/scene.h"
#include "viewer/controller/controller.h"

namespace sparsha::viewer {
namespace {

constexpr double kTurn_rad = 0.006;  // a pixel
constexpr double kLight_rad = 0.008;
constexpr double kTurn_deg = 0.35;       // of a whole object in the hand, a pixel
constexpr double kMostTurn_deg = 180.0;  // between two pictures
constexpr double kDoubleClick_s = 0.4;
constexpr double kSamePlace_px = 6.0;  // between the two clicks of a double one
constexpr double kOverview_s = 0.08;   // between two windows that a drag in the overview asks for

}  // namespace

std::optional<Clickable> Controller::box_at(const Eigen::Vector2d& place) const {
  for (auto box = boxes_.rbegin(); box != boxes_.rend(); ++box)
    if (box->rect.contains(place.x(), place.y())) return *box;
  return std::nullopt;
}

// What the mouse points at on the drawn stone.
Marking::Aim Controller::aim() {
  Marking::Aim aim;
  aim.stage = stage_;
  aim.height_at = drawn_at_;
  if (!scene_ || !view_ || !drawn_at_ || !layout_.detail.contains(mouse_.x(), mouse_.y()) || box_at(mouse_)) return aim;
  aim.view = view_;
  aim.pixel = {std::fmod(mouse_.x() - layout_.detail.x, view_->width), mouse_.y() - layout_.detail.y};
  const View::Ray ray = view_->ray(aim.pixel.x(), aim.pixel.y());
  const scene::SceneDescription& description = scene_->description();
  if (is_whole(description)) {
    const auto place = marking_.sight()->along(stage_.to_grid_m(ray.origin), stage_.turn.transpose() * ray.direction);
    if (place) aim.at_m = place->at_m;
    return aim;
  }
  aim.at_m = meet_surface(stage_.to_grid_m(ray.origin), ray.direction, drawn_at_, 0.0, description.height_min_m,
                          description.height_max_m, window().width_m / 200.0);
  return aim;
}

void Controller::mouse_move(double x, double y, const Layout& layout, const View& view, const Stage& stage,
                            const HeightAt& /*height*/) {
  const Eigen::Vector2d now(x, y);
  const Eigen::Vector2d moved = now - mouse_;
  mouse_ = now;
  layout_ = layout;
  view_ = view;
  if (grip_ == Grip::light) return turn_light(moved);
  if (grip_ == Grip::mark) {
    marking_.drag(aim());
    return;
  }
  if (grip_ == Grip::object) {
    hand_.forget_aim();
    turned_px_ += moved;
    return;
  }
  if (right_down_ || grip_ == Grip::camera) {
    hand_.forget_aim();
    return orbit_.turn(-kTurn_rad * moved.x(), -kTurn_rad * moved.y());
  }
  if (middle_down_) {
    hand_.forget_aim();
    if (scene_) orbit_.shift(moved, view, window().width_m / stage.unit_m);
    return;
  }
  if (grip_ == Grip::overview) {
    overview_waits_ = true;
    return;
  }
  const bool page = frame_.settings.help || frame_.asks_rescan;
  const bool over_stone =
      !page && (grip_ == Grip::hand || (grip_ == Grip::none && layout.detail.contains(x, y) && !box_at(now)));
  if (!frame_.has_pointer || frame_.looks || !over_stone || frame_.state.tick == 0) return;
  if (drag_key_ != 0) return drag_hand(now - moved, view);
  // Side by side, either eye's picture is pointed at.
  hand_.aim(view.ray(std::fmod(x - layout.detail.x, view.width), y - layout.detail.y));
  aimed_ = true;
}

void Controller::picture_drawn(const Layout& layout, const View& view) {
  const bool moved =
      view_ && (layout.detail != layout_.detail || view.width != view_->width || view.height != view_->height);
  if (std::exchange(aimed_, false) && moved) mouse_move(mouse_.x(), mouse_.y(), layout, view, stage_, {});
  aimed_ = false;
}

void Controller::press_left(int modifiers) {
  gripped_ = box_at(mouse_);
  if (gripped_) {
    grip_ = Grip::box;
  } else if (frame_.settings.help || frame_.asks_rescan) {
    grip_ = Grip::box;  // beside an open page: nothing behind it is touched
  } else if (layout_.overview.contains(mouse_.x(), mouse_.y())) {
    grip_ = Grip::overview;
    overview_s_ = -1.0;
    go_to_overview(mouse_);
  } else if (layout_.panel.contains(mouse_.x(), mouse_.y()) || layout_.bar.contains(mouse_.x(), mouse_.y())) {
    grip_ = Grip::box;
  } else if ((modifiers & kControl) != 0 && (modifiers & kShift) != 0) {
    grip_ = Grip::light;
  } else if ((modifiers & kControl) != 0 && scene_ && is_whole(scene_->description())) {
    grip_ = Grip::object;
  } else if (marking_.grip(aim(), frame_.settings.parts)) {
    grip_ = Grip::mark;
  } else if (frame_.looks || !frame_.has_pointer) {
    const bool twice = frame_.time_s - clicked_s_ < kDoubleClick_s && (mouse_ - clicked_).norm() < kSamePlace_px;
    clicked_s_ = twice ? -1.0 : frame_.time_s;
    clicked_ = mouse_;
    grip_ = Grip::camera;
    if (twice) centre_on(mouse_);
  } else {
    grip_ = Grip::hand;
    hand_.press(true);
  }
}

void Controller::release_left() {
  const Grip grip = std::exchange(grip_, Grip::none);
  if (grip == Grip::hand) hand_.press(false);
  if (grip == Grip::mark) marking_.release();
  if (grip == Grip::overview) overview_waits_ = true;
  if (grip == Grip::overview) overview_s_ = -1.0;
  if (grip == Grip::object) turn_object();
  if (grip != Grip::box || !gripped_ || !gripped_->rect.contains(mouse_.x(), mouse_.y())) return;
  if (gripped_->does == Clickable::Does::action) act(gripped_->action);
  if (gripped_->does == Clickable::Does::yes || gripped_->does == Clickable::Does::no)
    answer(gripped_->does == Clickable::Does::yes);
}

void Controller::mouse_button(int button, bool down, int modifiers) {
  if (button == 0) return down ? press_left(modifiers) : release_left();
  const bool covered = down && (box_at(mouse_) || frame_.settings.help || frame_.asks_rescan);
  if (covered) return;
  if (button == 1) right_down_ = down;
  if (button == 2) middle_down_ = down;
}

void Controller::mouse_wheel(double steps, int modifiers) {
  if (grip_ == Grip::hand && (modifiers & kControl) == 0) return hand_.wheel(steps);
  orbit_.zoom(std::pow(1.12, steps));
}

// The window moves under the picture meanwhile, so that only how far the mouse went counts and not where it is.
void Controller::drag_hand(const Eigen::Vector2d& from, const View& view) {
  const auto place = [&](const Eigen::Vector2d& mouse) {
    return view.on_plane(std::fmod(mouse.x() - layout_.detail.x, view.width), mouse.y() - layout_.detail.y,
                         frame_.camera.target.z());
  };
  const auto before = place(from), after = place(mouse_);
  if (!before || !after) return;
  const Eigen::Vector3d moved_m = frame_.state.scale * (stage_.to_grid_m(*after) - stage_.to_grid_m(*before));
  hand_.step(moved_m.x(), moved_m.y());
}

// A drag asks for no more windows than can be read.
void Controller::go_to_overview(const Eigen::Vector2d& place) {
  if (!scene_ || frame_.time_s - overview_s_ < kOverview_s) {
    overview_waits_ = true;
    return;
  }
  overview_s_ = frame_.time_s;
  overview_waits_ = false;
  const Rect& rect = layout_.overview;
  const View view = make_view(overview_camera(scene_->description(), stage_, rect), rect.width, rect.height);
  const auto world = view.on_plane(place.x() - rect.x, place.y() - rect.y, 0.0);
  if (world) wishes_.move_to(stage_.to_grid_m(*world).head<2>(), window());
}

void Controller::centre_on(const Eigen::Vector2d& place) {
  if (!scene_ || !view_) return;
  const auto world = view_->on_plane(std::fmod(place.x() - layout_.detail.x, view_->width),
                                     place.y() - layout_.detail.y, frame_.camera.target.z());
  if (world) wishes_.move_to(stage_.to_grid_m(*world).head<2>(), window());
}

// As if the front of the object were held: about the picture's upright and level axes, wherever it is seen from. Asked
// for once a picture, so that a fast mouse asks for no more turns than are shown.
void Controller::turn_object() {
  const Eigen::Vector2d way_px = std::exchange(turned_px_, Eigen::Vector2d::Zero());
  if (way_px.isZero()) return;
  const Eigen::Vector3d way_deg = kTurn_deg * (frame_.camera.axes() * Eigen::Vector3d(way_px.y(), way_px.x(), 0.0));
  wishes_.turn(way_deg * std::min(1.0, kMostTurn_deg / way_deg.norm()));
}

void Controller::turn_light(const Eigen::Vector2d& moved) {
  // As if a lamp were held over the stone: to the right is to the right, towards the middle of the picture is higher.
  auto& light = frame_.settings.light;
  const double reach = std::cos(light.elevation_rad);
  Eigen::Vector2d lamp(reach * std::cos(light.azimuth_rad), reach * std::sin(light.azimuth_rad));
  lamp += kLight_rad * Eigen::Vector2d(moved.x(), -moved.y());
  constexpr double kLowest = 0.12, kHighest = 1.5;
  light.azimuth_rad = std::atan2(lamp.y(), lamp.x());
  light.elevation_rad = std::clamp(std::acos(std::min(lamp.norm(), 1.0)), kLowest, kHighest);
}

}  // namespace sparsha::viewer
