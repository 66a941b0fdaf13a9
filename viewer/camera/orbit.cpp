// Turns, shifts and eases the camera.
#include "viewer/camera/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::viewer {
namespace {

constexpr double kFollow_s = 0.09;
constexpr double kField_rad = 0.5;       // vertical
constexpr double kMostTilt_rad = 3.1;    // the back, from below or above
constexpr double kUpright_rad = 1.5707;  // of a whole object: straight from above or below
constexpr double kNearest = 0.1, kFarthest = 40.0;

/// Distance from which `width` of the world fits the rectangle.
double fitting_distance(double width, double field_rad, const Rect& rect) {
  const double aspect = static_cast<double>(std::max(rect.width, 1)) / std::max(rect.height, 1);
  return 1.10 * 0.5 * width / (std::tan(0.5 * field_rad) * std::min(aspect, 1.0));
}

}  // namespace

Camera camera_for(const Window& window, const Ground& ground, const Stage& stage, double turn_rad, double tilt_rad,
                  double zoom, const Eigen::Vector2d& shift, const Rect& rect) {
  Camera camera;
  const double width = window.width_m / stage.unit_m;
  camera.turn_rad = turn_rad;
  camera.tilt_rad = tilt_rad;
  camera.field_rad = kField_rad;
  const Eigen::Vector3d middle_m(window.centre_m.x(), window.centre_m.y(), ground.middle_m);
  camera.target = stage.to_world(middle_m) + Eigen::Vector3d(shift.x() * width, shift.y() * width, 0.0);
  // What stands out towards the camera is seen whole; a tilted window's near edge comes closer as well.
  const double out = std::max(ground.high_m - ground.middle_m, 0.0) / stage.unit_m;
  camera.distance = (fitting_distance(width, camera.field_rad, rect) + out * std::abs(std::cos(tilt_rad)) +
                     0.35 * width * std::abs(std::sin(tilt_rad))) /
                    zoom;
  camera.half_height = camera.distance * std::tan(0.5 * camera.field_rad);
  camera.reach = std::max(camera.reach, 1.0 + 2.0 * out);
  return camera;
}

Camera camera_around(const Window& window, const Stage& stage, double turn_rad, double tilt_rad, double zoom,
                     const Eigen::Vector3d& shift, const Rect& rect) {
  constexpr double kDepth = 0.4;  // of the width: what stands out towards the camera
  Camera camera;
  const double width = window.width_m / stage.unit_m;
  camera.upright = true;
  camera.turn_rad = turn_rad;
  camera.tilt_rad = std::clamp(tilt_rad, -kUpright_rad, kUpright_rad);
  camera.field_rad = kField_rad;
  camera.target = stage.to_world(window.centre_m) + width * shift;
  camera.distance = (fitting_distance(width, camera.field_rad, rect) + kDepth * width) / zoom;
  camera.half_height = camera.distance * std::tan(0.5 * camera.field_rad);
  return camera;
}

void Orbit::set_whole(bool on) {
  if (on != whole_) reset();
  whole_ = on;
}

void Orbit::turn(double right_rad, double back_rad) {
  const double most_rad = whole_ ? kUpright_rad : kMostTilt_rad;
  turn_rad_ += right_rad;
  tilt_rad_ = std::clamp(tilt_rad_ + back_rad, -most_rad, most_rad);
}

void Orbit::zoom(double factor) { zoom_ = std::clamp(zoom_ * factor, kNearest, kFarthest); }

void Orbit::shift(const Eigen::Vector2d& pixels, const View& view, double width_world) {
  const double share = 1.0 / std::max(view.pixels_per_unit(view.focus) * width_world, 1e-9);
  Eigen::Vector3d turned(std::cos(turn_rad_) * pixels.x() + std::sin(turn_rad_) * pixels.y(),
                         std::sin(turn_rad_) * pixels.x() - std::cos(turn_rad_) * pixels.y(), 0.0);
  if (whole_) turned = pixels.x() * view.axes.col(0) - pixels.y() * view.axes.col(1);
  constexpr double kFar = 5.0;  // window widths
  shift_ = (shift_ - share * turned).cwiseMax(-kFar).cwiseMin(kFar);
}

void Orbit::reset() {
  turn_rad_ = tilt_rad_ = 0.0;
  zoom_ = 1.0;
  shift_.setZero();
}

void Orbit::update(double seconds, const Window& window, const Ground& ground, const Stage& stage, const Rect& rect,
                   Camera& now) {
  Camera goal = whole_ ? camera_around(window, stage, turn_rad_, tilt_rad_, zoom_, shift_, rect)
                       : camera_for(window, ground, stage, turn_rad_, tilt_rad_, zoom_, shift_.head<2>(), rect);
  // The shorter way round.
  now.turn_rad -= 2.0 * std::numbers::pi * std::round((now.turn_rad - goal.turn_rad) / (2.0 * std::numbers::pi));
  const bool parallel = parallel_;
  const double share = jumps_ ? 1.0 : 1.0 - std::exp(-seconds / kFollow_s);
  const bool near = (goal.target - now.target).norm() < 2e-4 * goal.distance &&
                    std::abs(goal.distance - now.distance) < 2e-4 * goal.distance &&
                    std::abs(goal.turn_rad - now.turn_rad) < 2e-4 && std::abs(goal.tilt_rad - now.tilt_rad) < 2e-4;
  if (jumps_ || near || !now.target.allFinite()) {
    now = goal;
  } else {
    now.target += share * (goal.target - now.target);
    now.distance *= std::pow(goal.distance / now.distance, share);
    now.turn_rad += share * (goal.turn_rad - now.turn_rad);
    now.tilt_rad += share * (goal.tilt_rad - now.tilt_rad);
  }
  now.upright = goal.upright;
  now.reach = goal.reach;
  now.field_rad = parallel ? 0.0 : goal.field_rad;
  now.half_height = now.distance * std::tan(0.5 * goal.field_rad);
  jumps_ = false;
}

}  // namespace sparsha::viewer
