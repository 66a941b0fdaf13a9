#include "haptics/device/falcon/guard.h"

#include <memory>
#include <optional>
#include <utility>

#include "base/system/confinement.h"
#include "haptics/device/falcon/packet.h"

namespace sparsha::haptics::falcon {
namespace {

/// A command that was cut off may swallow the first.
constexpr int kZeros = 3;
constexpr unsigned kInterface = 0, kOut = 0x02;

}  // namespace

ForceGuard::Zero zero_by_usb() {
  struct Port {
    bool confined = false;
    std::uint64_t device = 0;
    std::optional<system::UsbNode> node;
  };
  return [port = std::make_shared<Port>(), zero = encode({}, kHomingRequest | kLightRed)](std::uint64_t device,
                                                                                          bool send) {
    // The guard opens one node of the USB and writes to it; nothing else is its business.
    if (!std::exchange(port->confined, true)) system::confine_thread(system::Confinement::watch);
    if (device != port->device) {
      port->device = device;
      port->node.reset();
      if (device != 0)
        port->node.emplace(static_cast<unsigned>(device >> 32U), static_cast<unsigned>(device & 0xFFFFFFFFU));
    }
    return !send || !port->node || port->node->write_taking_over(kInterface, kOut, zero, kZeros);
  };
}

}  // namespace sparsha::haptics::falcon
