// A hand on a whole object that may be turned under the device: where the hand is in the object, and the proxy there.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptics/around/around_proxy.h"
#include "haptics/around/object_surface.h"

namespace sparsha::haptics {

/// How far a place (object frame) is behind the first surface that somebody meets who comes from far along `towards`
/// (unit); 0 where nothing is met before the place. Grid metres. Bounded; no allocation, no exceptions.
[[nodiscard]] double depth_behind_m(const ObjectSurface& object, const Eigen::Vector3d& place_m,
                                    const Eigen::Vector3d& towards, CellShape shape) noexcept;

/// Servo thread only; no allocation, no exceptions.
class ObjectHand {
 public:
  /// From the grid frame's axes to the device frame's; unit.
  [[nodiscard]] const Eigen::Quaterniond& turn() const noexcept { return turn_; }
  [[nodiscard]] const Eigen::Matrix3d& device_from_grid() const noexcept { return device_from_grid_; }
  void set_turn(const Eigen::Quaterniond& device_from_grid) noexcept {
    turn_ = device_from_grid;
    device_from_grid_ = turn_.toRotationMatrix();
  }
  [[nodiscard]] Eigen::Vector3d to_device(const Eigen::Vector3d& grid) const noexcept {
    return device_from_grid_ * grid;
  }
  [[nodiscard]] Eigen::Vector3d to_grid(const Eigen::Vector3d& device) const noexcept {
    return device_from_grid_.transpose() * device;
  }

  /// The proxy is the hand again at the next update, wherever that is.
  void let_go() noexcept { state_ = {}; }
  /// Lengths of the hand's way have another scale from now on.
  void rescale() noexcept { state_.proxy.track.known = false; }
  [[nodiscard]] bool touches() const noexcept { return state_.started && state_.sheet != kNoSheet; }
  /// The proxy, object frame; requires an update since let_go().
  [[nodiscard]] const Eigen::Vector3d& proxy_m() const noexcept { return state_.position_m; }
  /// What the last update gave for it, object frame: beside proxy_m() while a seam fades.
  [[nodiscard]] const Eigen::Vector3d& felt_m() const noexcept { return felt_m_; }
  [[nodiscard]] bool started() const noexcept { return state_.started; }

  [[nodiscard]] AroundUpdate update(const ObjectSurface& object, const Eigen::Vector3d& hip_m,
                                    const SolverOptions& options) noexcept {
    AroundUpdate found = update_around(object, hip_m, state_, options);
    felt_m_ = found.position_m;
    return found;
  }

 private:
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d device_from_grid_ = Eigen::Matrix3d::Identity();
  AroundState state_;
  Eigen::Vector3d felt_m_ = Eigen::Vector3d::Zero();
};

}  // namespace sparsha::haptics
