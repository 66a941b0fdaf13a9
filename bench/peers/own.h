// Our own solvers as entrants of the race: `exact`, `rounded`, `c1` and `paper`.
#pragma once

#include <string>

#include "bench/peers/peer.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::bench {

/// `method`: exact | rounded | c1 | paper; anything else throws std::invalid_argument. `options.shape` is set here.
[[nodiscard]] PeerPointer make_own(const haptics::MongeSurface& surface, const std::string& method,
                                   haptics::SolverOptions options);

}  // namespace sparsha::bench
