// A device that is only listened to.
#pragma once

#include <functional>

#include "haptics/device/device.h"

namespace sparsha::haptics {

/// Calls the device as the servo does, a thousand times a second, with zero force, until `each` returns false. Throws
/// Error{device} when it has not been connected for a second.
void each_sample(Device& device, const std::function<bool(const DeviceSample& sample, double time_s)>& each);

}  // namespace sparsha::haptics
