// A hand in software that somebody steers: for those who have keys and no haptic device.
#pragma once

#include <memory>

#include "haptics/device/device.h"
#include "haptics/device/steered/steering_script.h"
#include "haptics/state/seqlock.h"

namespace sparsha::haptics {

/// A simulated hand (docs/touch.md, "Simulated hand") that goes where the newest sample wants it, feels the forces of
/// the stone, and follows its surface by them. Without a first sample it waits in the air.
[[nodiscard]] std::unique_ptr<Device> make_steered_device(std::shared_ptr<const Seqlock<SteeringSample>> wish);

}  // namespace sparsha::haptics
