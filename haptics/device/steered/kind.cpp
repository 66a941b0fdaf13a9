#include "haptics/device/steered/kind.h"

#include "base/error.h"
#include "base/system/terminal.h"
#include "haptics/device/steered/steered_device.h"

namespace sparsha::haptics {

DeviceKind steered_kind() {
  return {"keys",
          nullptr,
          "keys of a terminal move a simulated hand",
          [](const DeviceRequest&) -> std::vector<FoundDevice> {
            const bool terminal = system::stdin_is_terminal();
            return {{"", terminal, terminal ? "" : "standard input is no terminal", {}}};
          },
          [](const DeviceRequest& request) {
            if (!system::stdin_is_terminal() || !request.keys)
              throw Error(ErrorKind::device, {}, "keys move the hand from a terminal, and standard input is none",
                          "a terminal in whose foreground the program runs");
            return make_steered_device(request.keys);
          },
          {}};
}

}  // namespace sparsha::haptics
