// A recorded path of the hand as a device: the servo renders it anew, on whatever scene.
#pragma once

#include <memory>

#include "haptics/device/device.h"
#include "haptics/replay/recording.h"

namespace sparsha::haptics {

/// Gives the recording's positions one row per reading, whatever the clock does, with their recorded times.
[[nodiscard]] std::unique_ptr<Device> make_path_device(std::shared_ptr<const Recording> recording);

/// The row as the device gave it.
[[nodiscard]] DeviceSample sample_of(const RecordedRow& row) noexcept;

/// The recorded device as it is played: paced by the recording's rows, with a warning of what a user should know.
[[nodiscard]] DeviceInfo played_device(const Recording& recording);

}  // namespace sparsha::haptics
