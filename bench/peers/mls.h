// `mls`: the proxy on a moving-least-squares surface of the raw points. C. H. Lee, Y. J. Kim, "Haptic rendering of
// point set surfaces", World Haptics 2007: weighted mean a(x) and normal n(x) of the points near x (Adamson & Alexa
// 2003), the surface where n(x).(x - a(x)) = 0, the proxy tracked along its tangent plane. Normals by principal
// components.
#pragma once

#include "bench/peers/peer.h"

namespace sparsha::bench {

struct MlsOptions {
  double width_spacings = 0.5;  ///< of the Gaussian weight exp(-r^2 / width^2)
  int iterations = 20;          ///< tangent steps per tick, at most
};

[[nodiscard]] PeerPointer make_mls(const haptics::MongeSurface& surface, const MlsOptions& options);

}  // namespace sparsha::bench
