// The Falcon as the program uses it.
#pragma once

#include <memory>

#include "haptics/device/device.h"

namespace sparsha::app {

/// Opens the Falcon. Throws Error{device} with the remedy.
[[nodiscard]] std::unique_ptr<haptics::Device> open_falcon();
/// The same, or null when none is connected.
[[nodiscard]] std::unique_ptr<haptics::Device> find_falcon();

}  // namespace sparsha::app
