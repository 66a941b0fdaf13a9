// What `sparsha device check|monitor|home` do: each step of starting a Falcon with its remedy, live readings,
// homing.
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

/// One answer, understood.
struct Reading {
  double time_s = 0.0;  ///< since the first question
  double round_trip_s = 0.0;
  Answer answer;
  bool homed = false;
  bool reachable = false;  ///< position_m is that of the counts (true only when homed does it mean anything)
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< Falcon frame
};

/// Asks with zero force until `each` returns false. Throws Error{device} when unplugged or silent for a second.
void monitor(Transport& wire, const std::function<bool(const Reading&)>& each);

/// Asks for homing, red light, until all three encoders are homed (then green) or `timeout_s` is over; true when homed.
/// `each` may show the way (homing_advice()), and ends it by false.
[[nodiscard]] bool home(Transport& wire, double timeout_s, const std::function<bool(const Reading&)>& each = {});

}  // namespace sparsha::haptics::falcon
