#include "haptics/device/pointer/kind.h"

#include "base/error.h"
#include "haptics/device/pointer/pointer_device.h"

namespace sparsha::haptics {

DeviceKind pointer_kind() {
  return {"pointer",
          nullptr,
          "the mouse is the hand",
          [](const DeviceRequest& request) -> std::vector<FoundDevice> {
            return {{"", request.window, request.window ? "" : "it needs a display", {}}};
          },
          [](const DeviceRequest& request) {
            if (!request.window || !request.pointer)
              throw Error(ErrorKind::device, {}, "the pointer device needs a window, and there is none",
                          "a display and no --headless, or --device simulated");
            return make_pointer_device(request.pointer);
          },
          {}};
}

}  // namespace sparsha::haptics
