// The wire to a real Falcon through libusb.
#pragma once

#include <memory>

#include "haptics/device/falcon/transport.h"

namespace sparsha::haptics::falcon {

inline constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xCB48;

/// Opens and claims the first Falcon. Throws Error{device}: none there, not allowed (with the udev rule), taken by
/// another program.
[[nodiscard]] std::unique_ptr<Transport> open_usb_transport();

}  // namespace sparsha::haptics::falcon
