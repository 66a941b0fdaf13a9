// The wire to a real Falcon through libusb.
#pragma once

#include <memory>

#include "haptics/device/falcon/transport.h"

namespace sparsha::haptics::falcon {

inline constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xCB48;

/// Why no Falcon was opened.
enum class OpenProblem : std::uint8_t { none, no_usb, absent, not_permitted, busy };

/// Opens and claims the first Falcon that is free; null with the problem.
[[nodiscard]] std::unique_ptr<Transport> try_usb_transport(OpenProblem& problem);
/// The same. Throws Error{device}: none there, not allowed (with the udev rule), taken by
/// another program.
[[nodiscard]] std::unique_ptr<Transport> open_usb_transport();

}  // namespace sparsha::haptics::falcon
