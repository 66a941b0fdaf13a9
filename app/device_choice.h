// Which device `--device` means.
#pragma once

#include <memory>
#include <string>

#include "haptics/device/device.h"
#include "haptics/shared/seqlock.h"
#include "haptics/shared/state.h"

namespace sparsha::app {

struct ChosenDevice {
  std::unique_ptr<haptics::Device> device;
  std::shared_ptr<haptics::Seqlock<haptics::PointerSample>> pointer;  ///< with the pointer device only
};

/// `name`: auto | falcon | pointer | simulated | playback:FILE. `window`: a window will be open. `duration_s` bounds
/// the simulated round, 0 = for ever. Throws Error{device} that names the choices, Error{usage} for another name.
[[nodiscard]] ChosenDevice choose_device(const std::string& name, bool window, double duration_s);

}  // namespace sparsha::app
