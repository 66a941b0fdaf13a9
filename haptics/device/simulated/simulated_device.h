// The simulated hand as a device.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/device/simulated/exploration_script.h"

namespace sparsha::haptics {

/// A simulated hand (docs/touch.md, "Simulated hand") that follows a seeded script of free space, approach, press,
/// stroke and lift: first touch within 3 s, at least 20 % of ticks in contact. The stops of `tour` come first.
/// `duration_s` 0 = for ever.
[[nodiscard]] std::unique_ptr<Device> make_simulated_device(std::uint64_t seed, double duration_s,
                                                            std::vector<TourStop> tour = {});

}  // namespace sparsha::haptics
