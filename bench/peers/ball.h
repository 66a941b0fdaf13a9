// `god-object` with a radius: a ball on the triangle mesh. D. C. Ruspini, K. Kolarov, O. Khatib, "The haptic display of
// complex graphical environments", SIGGRAPH 1997. Force: from the hand to the ball's surface, so that it is comparable
// with that of a point.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct BallOptions {
  double radius_spacings = 1.0;
  int moves = 100;  ///< of the ball per tick, at most; none is longer than its radius
};

[[nodiscard]] PeerPointer make_ball(const haptics::MongeSurface& surface, const BallOptions& options);

}  // namespace sparsha::bench
