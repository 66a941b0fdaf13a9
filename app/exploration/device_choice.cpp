// `--device auto` takes a Falcon, else the pointer when there is a display, else it is an error; it never takes the
// simulated hand.
#include "app/exploration/device_choice.h"

#include "app/exploration/tour.h"
#include "base/error.h"
#include "base/system/terminal.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/pointer/pointer_device.h"
#include "haptics/device/simulated/simulated_device.h"
#include "haptics/device/steered/steered_device.h"
#include "haptics/replay/path_device.h"
#include "scene/scene.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace {

constexpr std::uint64_t kSeed = 1;  // of the simulated round: every run feels the same
const char* const kChoices =
    "--device keys (at a terminal), falcon, pointer (needs a window), simulated or playback:FILE";

ChosenDevice pointer_device() {
  ChosenDevice chosen;
  chosen.pointer = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  chosen.device = haptics::make_pointer_device(chosen.pointer);
  return chosen;
}

}  // namespace

ChosenDevice choose_device(const std::string& name, bool window, const haptics::falcon::FalconOptions& falcon) {
  ChosenDevice chosen;
  if (name == "simulated") {
    chosen.simulated = true;
  } else if (name.starts_with("playback:")) {
    auto recording = std::make_shared<const haptics::Recording>(name.substr(std::string("playback:").size()));
    // A path of the hand alone is rendered anew, as if the hand were there.
    if (recording->windows().empty())
      chosen.device = haptics::make_path_device(std::move(recording));
    else
      chosen.recording = std::move(recording);
  } else if (name == "pointer") {
    if (!window) {
      throw Error(ErrorKind::device, {}, "the pointer device needs a window, and there is none",
                  "a display and no --headless, or --device simulated");
    }
    return pointer_device();
  } else if (name == "keys") {
    if (!system::stdin_is_terminal()) {
      throw Error(ErrorKind::device, {}, "keys move the hand from a terminal, and standard input is none",
                  "a terminal in whose foreground the program runs");
    }
    chosen.keys = std::make_shared<haptics::Seqlock<haptics::SteeringSample>>();
    chosen.device = haptics::make_steered_device(chosen.keys);
  } else if (name == "falcon") {
    chosen.device = haptics::falcon::make_falcon_device(falcon);
  } else if (name == "auto") {
    if (!haptics::falcon::find_falcons().empty()) {
      chosen.device = haptics::falcon::make_falcon_device(falcon);
    } else if (window) {
      return pointer_device();
    } else {
      throw Error(ErrorKind::device, {}, "no Falcon is connected and there is no window for the pointer", kChoices);
    }
  } else {
    throw usage_error("there is no device '" + name + "'",
                      "auto | falcon | pointer | keys | simulated | playback:FILE");
  }
  return chosen;
}

std::unique_ptr<haptics::Device> simulated_hand(const scene::SceneDescription& scene, double duration_s) {
  return haptics::make_simulated_device(kSeed, duration_s, tour_of(scene));
}

}  // namespace sparsha::app
