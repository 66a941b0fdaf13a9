// `box`: a box round every point. N. R. El-Far, N. D. Georganas, A. El Saddik, "An algorithm for haptically rendering
// objects described by point clouds", CCECE 2008: the boxes that hold the hand say how deep it is and in which
// direction; no proxy, so that a hand below the boxes is lost. Normals by principal components.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct BoxOptions {
  double half_side_spacings = 3.0;  ///< of a box; deeper than this there is no force
};

[[nodiscard]] PeerPointer make_box(const haptics::MongeSurface& surface, const BoxOptions& options);

}  // namespace sparsha::bench
