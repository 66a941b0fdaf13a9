// The mouse among other devices.
#pragma once

#include "haptics/device/kind.h"

namespace sparsha::haptics {

[[nodiscard]] DeviceKind pointer_kind();

}  // namespace sparsha::haptics
