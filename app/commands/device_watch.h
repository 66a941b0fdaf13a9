// `sparsha device monitor`, `home` and `check` of any device.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "app/commands/commands.h"
#include "haptics/device/device.h"
#include "haptics/device/kind.h"

namespace sparsha::app {

/// Prints ten lines a second, for `duration_s` or, when that is 0, until stopped.
int monitor_device(haptics::Device& device, const CommonOptions& common, double duration_s);

/// Waits for a minute until the device knows its place; `say` is told what it wants of the person meanwhile, phrase by
/// phrase. Throws Error{device} when it does not come to that.
int home_device(haptics::Device& device, const CommonOptions& common, const std::function<void(const char*)>& say);

struct CheckWish {
  double seconds = 10.0;     ///< for which the link, or the device, is watched
  bool conformance = false;  ///< each fault that a driver may have is tried under the servo
};
/// Every step to the device with its remedy. Throws Cancelled when the request's `stop` ends opening.
[[nodiscard]] haptics::CheckReport check_device(const haptics::DeviceKind& kind, const haptics::DeviceRequest& request,
                                                const CheckWish& wish);

}  // namespace sparsha::app
