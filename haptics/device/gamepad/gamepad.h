// Hands without force: a gamepad, whose shaking follows the force, and a tablet's pen. Not tried on hardware.
#pragma once

#include <functional>
#include <memory>

#include "base/system/gamepad.h"
#include "haptics/device/device.h"
#include "haptics/device/kind.h"

namespace sparsha::haptics {

/// A simulated hand. Gamepad: the left stick moves it at up to 60 mm/s and the directional pad at 15, the right trigger
/// lowers it into the stone, and the motors shake when the stone is met and as rough as it is. Tablet: the pen's place
/// is the hand's, its pressure the depth, its tilt the orientation. A pad that is unplugged is so for the servo; then
/// `reopen` is asked twice a second, on another thread, for one to go on with. `pad` may be null where there is a
/// `reopen`: one that is still to come.
[[nodiscard]] std::unique_ptr<Device> make_pad_device(std::unique_ptr<system::Pad> pad, system::PadKind kind,
                                                      std::function<std::unique_ptr<system::Pad>()> reopen = nullptr);

[[nodiscard]] DeviceKind gamepad_kind();
[[nodiscard]] DeviceKind tablet_kind();

}  // namespace sparsha::haptics
