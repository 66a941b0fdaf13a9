// The camera relative to the window that the hand reaches, and its way there.
#pragma once

#include <Eigen/Core>

#include "viewer/camera/camera.h"
#include "viewer/frame.h"

namespace sparsha::viewer {

/// The drawn surface within a window, grid frame: heights that the camera looks at and must not run into.
struct Ground {
  double middle_m = 0.0;
  double high_m = 0.0;
};

/// The camera that frames a window: `zoom` 1 fits it into the rectangle.
[[nodiscard]] Camera camera_for(const Window& window, const Ground& ground, const Stage& stage, double turn_rad,
                                double tilt_rad, double zoom, const Eigen::Vector2d& shift, const Rect& rect);

/// The same for a whole object: around the window's middle, from every side. `shift`: world, in window widths.
[[nodiscard]] Camera camera_around(const Window& window, const Stage& stage, double turn_rad, double tilt_rad,
                                   double zoom, const Eigen::Vector3d& shift, const Rect& rect);

class Orbit {
 public:
  /// A whole object is looked at from all around, a relief from before and behind.
  void set_whole(bool on);
  void turn(double right_rad, double back_rad);
  void zoom(double factor);
  /// Moves what is seen by so many pixels of `view`.
  void shift(const Eigen::Vector2d& pixels, const View& view, double width_world);
  /// Straight on, the whole window in view.
  void reset();
  void set_parallel(bool on) { parallel_ = on; }
  [[nodiscard]] bool parallel() const { return parallel_; }
  /// The next update() jumps to the goal.
  void jump() { jumps_ = true; }
  /// Brings `camera` nearer to where it is wanted.
  void update(double seconds, const Window& window, const Ground& ground, const Stage& stage, const Rect& rect,
              Camera& camera);

 private:
  double turn_rad_ = 0.0, tilt_rad_ = 0.0, zoom_ = 1.0;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();  // world, in window widths
  bool parallel_ = false;
  bool whole_ = false;
  bool jumps_ = true;
};

}  // namespace sparsha::viewer
