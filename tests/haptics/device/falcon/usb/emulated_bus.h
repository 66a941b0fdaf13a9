// A USB bus with an emulated Falcon on it: unmodified libusb programs of this process see a device 0403:cb48.
#pragma once

#include <memory>

#include "haptics/device/falcon/emulator.h"

namespace emulated_bus {

/// Works only with umockdev's library preloaded.
[[nodiscard]] bool possible();

class Bus {
 public:
  explicit Bus(std::shared_ptr<sparsha::haptics::falcon::FalconEmulator> falcon);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace emulated_bus
