// The hand that keys move among other devices.
#pragma once

#include "haptics/device/kind.h"

namespace sparsha::haptics {

[[nodiscard]] DeviceKind steered_kind();

}  // namespace sparsha::haptics
