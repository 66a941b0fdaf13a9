// The methods of the race by name and setting.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct Entrant {
  std::string method;    ///< of the column `method`
  std::string setting;   ///< what differs from other entrants of this method, with its unit
  bool standard = true;  ///< the one setting of its method that runs everywhere; others run for the front only
  std::function<PeerPointer(const haptics::MongeSurface&)> make;
};

[[nodiscard]] std::vector<Entrant> all_entrants();

}  // namespace sparsha::bench
