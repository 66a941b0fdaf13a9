#include "haptics/session/object_before.h"

#include <limits>

#include "haptics/servo/object_hand.h"
#include "haptics/state/vectors.h"

namespace sparsha::haptics {

double ObjectBefore::z_m(const Eigen::Vector2d& device_m, const State& state) const {
  if (object_ == nullptr || (state.flags & kFlagAround) == 0 || !(state.scale > 0.0))
    return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Quaterniond grid_from_device(state.turn[3], -state.turn[0], -state.turn[1], -state.turn[2]);
  const Eigen::Vector3d towards = grid_from_device * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d across_m = grid_from_device * Eigen::Vector3d(device_m.x(), device_m.y(), 0.0) / state.scale;
  const Eigen::Vector3d place_m = to_vector(state.centre_m) + across_m - object_->origin_m;
  const double behind_m = object_->box_m.diagonal().norm() + (place_m - object_->box_m.center()).norm();
  const double depth_m = depth_behind_m(*object_, place_m - behind_m * towards, towards, CellShape::rounded);
  return depth_m > 0.0 ? state.scale * (depth_m - behind_m) : -state.workspace_m;
}

}  // namespace sparsha::haptics
