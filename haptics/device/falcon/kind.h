// The Falcon among other devices.
#pragma once

#include "haptics/device/falcon/falcon.h"
#include "haptics/device/kind.h"

namespace sparsha::haptics::falcon {

/// What of a request concerns a Falcon.
[[nodiscard]] FalconOptions options_of(const DeviceRequest& request);
[[nodiscard]] DeviceKind falcon_kind();

}  // namespace sparsha::haptics::falcon
