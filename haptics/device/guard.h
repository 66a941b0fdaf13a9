// Zero force when this program can no longer send it: killed, crashed or stopped. A process of its own watches a pulse.
#pragma once

#include <cstdint>
#include <functional>

#include "base/system/process.h"

namespace sparsha::haptics {

class ForceGuard {
 public:
  /// Called in the guard's process. Sends zero to the device that a word names, past whoever holds it; false when that
  /// did not go through, and may the next time. It keeps what it needs between calls, and sees each new name once with
  /// `send` false, while all is well.
  using Zero = std::function<bool(std::uint64_t device, bool send)>;

  /// Before any other thread touches the device's bus. Throws Error{failure} when the system gives no process.
  explicit ForceGuard(const Zero& zero);

  // From any thread; these neither lock nor call the system.
  /// The device whose motors are meant, in `zero`'s words; 0 while there is none.
  void watch(std::uint64_t device) noexcept;
  /// A sign of life of whoever decides the force.
  void beat() noexcept;
  /// True before a force goes out; false once the device has answered to zeros.
  void set_force(bool on) noexcept;

 private:
  system::Companion companion_;
};

}  // namespace sparsha::haptics
