// `sphere`: a spherical proxy on the raw points, without mesh or normals. K. G. Sreeni, S. Chaudhuri, "Haptic rendering
// of dense 3D point cloud data", IEEE Haptics Symposium 2012: the ball is pushed out of the points in it and moves
// along the tangent plane of the mean push. Force: from the hand to the ball's surface.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct SphereOptions {
  double radius_spacings = 3.0;  ///< at most a little more than 1 may pass between points
  int iterations = 60;           ///< per tick, at most
};

[[nodiscard]] PeerPointer make_sphere(const haptics::MongeSurface& surface, const SphereOptions& options);

}  // namespace sparsha::bench
