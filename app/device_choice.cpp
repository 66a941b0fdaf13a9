// auto: a Falcon, else the pointer when there is a display, else an error; never the simulated hand.
#include "app/device_choice.h"

#include "haptics/device/devices.h"
#include "haptics/device/falcon/falcon.h"
#include "pipeline/base/error.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace {

constexpr std::uint64_t kSeed = 1;  // of the simulated round: every run feels the same
const char* const kChoices = "--device falcon, pointer (needs a window), simulated or playback:FILE";

ChosenDevice pointer_device() {
  ChosenDevice chosen;
  chosen.pointer = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  chosen.device = haptics::make_pointer_device(chosen.pointer);
  return chosen;
}

}  // namespace

ChosenDevice choose_device(const std::string& name, bool window, double duration_s) {
  ChosenDevice chosen;
  if (name == "simulated") {
    chosen.device = haptics::make_simulated_device(kSeed, duration_s);
  } else if (name.starts_with("playback:")) {
    chosen.device = haptics::make_playback_device(name.substr(std::string("playback:").size()));
  } else if (name == "pointer") {
    if (!window) {
      throw Error(ErrorKind::device, {}, "the pointer device needs a window, and there is none",
                  "a display and no --headless, or --device simulated");
    }
    return pointer_device();
  } else if (name == "falcon") {
    chosen.device = haptics::falcon::make_falcon_device();
  } else if (name == "auto") {
    if (!haptics::falcon::find_falcons().empty()) {
      chosen.device = haptics::falcon::make_falcon_device();
    } else if (window) {
      return pointer_device();
    } else {
      throw Error(ErrorKind::device, {}, "no Falcon is connected and there is no window for the pointer", kChoices);
    }
  } else {
    throw usage_error("there is no device '" + name + "'", "auto | falcon | pointer | simulated | playback:FILE");
  }
  return chosen;
}

}  // namespace sparsha::app
