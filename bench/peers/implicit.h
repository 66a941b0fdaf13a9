// `implicit`: the proxy on a level set of a density of the raw points, without normals. A. Leeper, S. Chan, K.
// Salisbury, "Point clouds can be represented as implicit surfaces for constraint-based haptic rendering", ICRA 2012:
// metaballs of compact support. The level set lies a little above the points; its height over a plane of this spacing
// is taken off the force.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct ImplicitOptions {
  double radius_spacings = 2.5;  ///< support of a point; below 2 the surface has holes
  int iterations = 20;           ///< tangent steps per tick, at most
};

[[nodiscard]] PeerPointer make_implicit(const haptics::MongeSurface& surface, const ImplicitOptions& options);

}  // namespace sparsha::bench
