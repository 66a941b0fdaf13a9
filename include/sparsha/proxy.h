// The point proxy: where a fingertip that cannot enter the surface comes to rest, for one position of the hand.
//
//   haptics::start_proxy    the state for a first position of the hand
//   haptics::update_exact   one tick by the exact active-set solver: proxy, unit normal, contact, sticking
//   haptics::update_paper   one tick by the iteration of Aniyath et al. 2014, eq. 1 to 6
//   haptics::move_proxy     the same proxy on another surface
//   haptics::ProxyState     what is kept between ticks; a value, one for each hand
//   haptics::SolverOptions  tolerance in cells, limit of segments, what lies between the nodes
//
// Local frame of the surface, metres. noexcept, no allocation, no locks: made for the servo thread, and usable on any
// as long as each thread has a state of its own. The time of a tick grows with the cells that the proxy crosses in it,
// at most `segment_limit`, after which `unfinished` is set and the next tick goes on (docs/measure/figures.md has the
// times). A hand that is not finite leaves the state as it was. The force is the caller's: stiffness * scale * (proxy -
// hand).
#pragma once

#include "haptics/proxy/proxy.h"
#include "sparsha/surface.h"
