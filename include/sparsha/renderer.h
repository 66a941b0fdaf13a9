// From a position of the hand to a force, one tick at a time: proxy, friction, effects, passivity and limits.
//
//   haptics::HapticRenderer   update(sample) takes a hand's position to state().commanded_force_n (newtons, device
//   frame) haptics::RendererOptions  rate in Hz, wished stiffness in N/m, solver, longest gap in seconds
//   haptics::HapticWindow     the surface that is touched; the renderer keeps a share of it
//   haptics::State            positions (metres, grid frame unless said otherwise), forces, flags of the last tick
//   haptics::ContactEvent     begin and end of a contact, for sound
//
// For programs with a loop of their own; sparsha/servo.h has one. One thread at a time; update() is noexcept, allocates
// nothing and makes no system call. After fault() the force is zero until the hand has been in free space. The governor
// follows the passivity observer of Hannaford & Ryu 2002 (docs/touch.md, "Governor").
#pragma once

#include "haptics/servo/haptic_renderer.h"
#include "haptics/state/state.h"
#include "sparsha/device.h"
#include "sparsha/proxy.h"
