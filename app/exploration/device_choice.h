// Which device `--device` means.
#pragma once

#include <memory>
#include <string>

#include "haptics/device/device.h"
#include "haptics/device/kind.h"
#include "haptics/device/steered/steering_script.h"
#include "haptics/replay/recording.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/state.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

struct ChosenDevice {
  std::unique_ptr<haptics::Device> device;                            ///< null when a run is played or simulated
  bool simulated = false;                                             ///< simulated_hand() once the scene is known
  std::shared_ptr<const haptics::Recording> recording;                ///< null unless it is
  std::shared_ptr<haptics::Seqlock<haptics::PointerSample>> pointer;  ///< with the pointer device only
  std::shared_ptr<haptics::Seqlock<haptics::SteeringSample>> keys;    ///< with a hand that keys move
};

/// `name`: one of device_names(). `request`: what a device may need; the argument and the mouse and keys are put in
/// here. Throws Error{device} that names the choices, Error{usage} for another name.
[[nodiscard]] ChosenDevice choose_device(const std::string& name, haptics::DeviceRequest request = {});

/// The simulated hand, every time with the same seed: a tour of the scene, then rounds by chance. `duration_s` 0 = for
/// ever.
[[nodiscard]] std::unique_ptr<haptics::Device> simulated_hand(const scene::SceneDescription& scene, double duration_s);

}  // namespace sparsha::app
