// A device whose driver somebody else has written against sparsha/device_plugin.h: `--device plugin:FILE.so`.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "haptics/device/device.h"
#include "haptics/device/kind.h"

namespace sparsha::haptics::plugin {

/// Loads it into a process of its own and opens its device; `stop` ends that, which may take ten seconds. Whatever the
/// plug-in does (crash, hang, values that cannot be, another rate than it says), the force is zero and advice() tells.
/// Throws Error{device} with what the plug-in says, or what is wrong with it; Cancelled.
[[nodiscard]] std::unique_ptr<Device> make_plugin_device(const std::filesystem::path& file,
                                                         const std::function<bool()>& stop = {});

[[nodiscard]] DeviceKind plugin_kind();

}  // namespace sparsha::haptics::plugin
