// How the guard's process sends zero to a Falcon.
#pragma once

#include <cstdint>

#include "haptics/device/falcon/transport.h"
#include "haptics/device/guard.h"

namespace sparsha::haptics::falcon {

/// Takes the USB interface from whoever holds it and writes zeros.
[[nodiscard]] ForceGuard::Zero zero_by_usb();
/// A Falcon's place as the guard's word; 0 for none.
[[nodiscard]] constexpr std::uint64_t guarded(const UsbAddress& device) noexcept {
  return (std::uint64_t{device.bus} << 32U) | device.address;
}

}  // namespace sparsha::haptics::falcon
