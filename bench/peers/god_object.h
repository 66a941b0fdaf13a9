// `god-object`: the constraint-based proxy on a triangle mesh. C. B. Zilles, J. K. Salisbury, "A constraint-based
// god-object method for haptic display", IROS 1995; sliding on within a tick after D. C. Ruspini, K. Kolarov, O.
// Khatib, "The haptic display of complex graphical environments", SIGGRAPH 1997. Radius 0.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct GodObjectOptions {
  int moves = 100;  ///< moves of the proxy per tick, at most; 1: the constraints of one tick, as published in 1995
};

[[nodiscard]] PeerPointer make_god_object(const haptics::MongeSurface& surface, const GodObjectOptions& options);

}  // namespace sparsha::bench
