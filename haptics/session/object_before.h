// What of a whole object is before a place of the workspace, for hands that see only the picture.
#pragma once

#include <Eigen/Core>

#include "haptics/servo/command.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Session's thread only.
class ObjectBefore {
 public:
  /// The newest window; its surface is kept alive.
  void know(const HapticWindow& window) {
    surface_ = window.surface;
    object_ = window.object;
  }
  /// z of the first surface that somebody meets who comes towards a place along the device's z axis, device frame; as
  /// far behind as the workspace is wide where there is none, NaN for one view.
  [[nodiscard]] double z_m(const Eigen::Vector2d& device_m, const State& state) const;

 private:
  SurfacePointer surface_;
  const ObjectSurface* object_ = nullptr;
};

}  // namespace sparsha::haptics
