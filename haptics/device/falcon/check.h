// What `sparsha device check` does: each step of starting a Falcon with its remedy.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "haptics/device/device_check.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/falcon/link.h"

namespace sparsha::haptics::falcon {

using haptics::CheckReport;
using haptics::CheckStep;
using haptics::LinkQuality;
using haptics::LinkVerdict;

[[nodiscard]] LinkVerdict judge(const LinkQuality& link);

/// Walks all steps on the first Falcon on USB. Forces stay zero. Never throws for what is wrong with the device; throws
/// Cancelled when options.stop ends the loading of firmware. Ended while the link is measured, it judges what it has.
[[nodiscard]] CheckReport check_falcon(const FalconOptions& options = {}, double link_s = 10.0);
/// The steps from power on, over any wire. `link_s`: how long the link is measured.
[[nodiscard]] CheckReport check_wire(Transport& wire, const FalconOptions& options, double link_s = 1.0);

}  // namespace sparsha::haptics::falcon
