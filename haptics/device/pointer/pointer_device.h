// The mouse as a device.
#pragma once

#include <memory>

#include "haptics/device/device.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// The hand is where the viewer's pointer is, as far as the force does not become greater than the pointer allows.
[[nodiscard]] std::unique_ptr<Device> make_pointer_device(std::shared_ptr<const Seqlock<PointerSample>> pointer);

}  // namespace sparsha::haptics
