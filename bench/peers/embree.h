// `embree`: the closest point of the triangle mesh by Intel's Embree 3 (Apache 2.0), where it was found when this was
// built. No proxy: the force leads to whatever is nearest, so that a hand deep in a wall is pushed out at its back.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

/// Built with Embree?
[[nodiscard]] bool has_embree();
/// Throws std::runtime_error without Embree, or when it fails.
[[nodiscard]] PeerPointer make_embree(const haptics::MongeSurface& surface);

}  // namespace sparsha::bench
