// Emulated Falcons on an emulated USB bus: programs that umockdev's library is preloaded into see devices 0403:cb48
// through their own libusb. Linux with umockdev; elsewhere the bus says that it cannot be.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "emulator/falcon.h"

namespace sparsha::emulator {

/// What goes wrong with the transfers. 0 = never.
struct BusFaults {
  double stall_every_s = 0.0;   ///< the IN endpoint stalls so often, until it is cleared
  int fail_every = 0;           ///< every n-th bulk transfer fails once
  double unplug_after_s = 0.0;  ///< so long after its first force the device is unplugged, again and again
  double replug_after_s = 1.0;  ///< and comes back so much later, without power meanwhile
  bool power_only = false;      ///< what is unplugged is its power supply, not USB
  double dead_after_s = 0.0;    ///< so long after the first force every bulk transfer fails
  double dead_for_s = 1.5;      ///< for so long
};

class UsbBus {
 public:
  /// Throws Error{device} where there is no umockdev. Several Falcons stand at ports of their own, in this order.
  explicit UsbBus(std::vector<std::shared_ptr<Falcon>> falcons, const BusFaults& faults = {});
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  /// What a program's environment must hold beside its own to be on this bus.
  [[nodiscard]] static std::vector<std::pair<std::string, std::string>> environment();
  /// True when this program itself is on it.
  [[nodiscard]] static bool preloaded();

  void unplug(std::size_t port);
  /// With a new address, as any device that is plugged in again. `power`: it had its own supply and has lost nothing.
  void replug(std::size_t port, bool power);

  /// While on, writes wait for the device, which takes none.
  void hold_writes(std::size_t port, bool on);
  /// Requests of the bus (submitting, reaping, asking in vain) for each command since the last control transfer, which
  /// ends the opening; negative: too few to tell.
  [[nodiscard]] double requests_per_command(std::size_t port) const;

  /// On the clock of the wire's log.
  [[nodiscard]] double now_s() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::emulator
