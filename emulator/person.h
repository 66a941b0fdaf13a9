// A person at the emulated grip: homes the device when its light is red, comes to the front when it is green, and
// touches what is there when it is blue; a hand with mass, stiffness and damping that feels the motors.
#pragma once

#include <cstdint>
#include <functional>

#include "emulator/falcon.h"

namespace sparsha::emulator {

/// Where the person wants the grip, Falcon frame, after `dt_s` more, given what the hand feels and where it is. Called
/// once a command while the light is blue.
struct Wish {
  Vec3 place_m{};
  std::uint8_t buttons = 0;
};
using Explore = std::function<Wish(double dt_s, const Vec3& felt_n, const Vec3& hand_m)>;

struct PersonOptions {
  double mass_kg = 0.15;             ///< hand and device together
  double stiffness_n_per_m = 300.0;  ///< of the grasp
  double damping_n_s_per_m = 4.0;
  double weight_kg = 0.0;  ///< > 0: lets the grip go in the middle, and hangs this on it later
  double weight_after_s = 25.0;
  Explore explore;  ///< empty: presses and strokes whatever is below, and lifts, for ever
};

/// A hand for Falcon::set_hand(). Copies share one person.
[[nodiscard]] Falcon::Hand make_person(PersonOptions options = {});

}  // namespace sparsha::emulator
