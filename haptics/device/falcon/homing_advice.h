// How a person makes all three encoders know their places.
#pragma once

#include <cstdint>

#include "haptics/device/device.h"

namespace sparsha::haptics::falcon {

/// Homing that has not come further for so long needs a more exact word.
inline constexpr double kSlowHoming_s = 4.0;

/// `homed`: bit i set once encoder i (top, right, left) knows its place. `slow`: nothing has changed for kSlowHoming_s;
/// the arms that are missing are then named.
[[nodiscard]] const DeviceAdvice* homing_advice(std::uint8_t homed, bool slow) noexcept;

}  // namespace sparsha::haptics::falcon
