// Zero force when this program can no longer send it: killed, crashed or stopped. A process of its own watches a pulse.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "base/system/process.h"
#include "haptics/device/falcon/transport.h"

namespace sparsha::haptics::falcon {

class ForceGuard {
 public:
  /// Before any other thread touches USB. Throws Error{failure} when the system gives no process.
  ForceGuard();

  // From any thread; these neither lock nor call the system.
  /// The device whose motors are meant; none while it is unplugged.
  void watch(const UsbAddress& device) noexcept;
  /// A sign of life of whoever decides the force.
  void beat() noexcept;
  /// True before a force goes out; false once the device has answered to zeros.
  void set_force(bool on) noexcept;

 private:
  system::Companion companion_;
};

}  // namespace sparsha::haptics::falcon
