// `--device auto` takes a Falcon, else the pointer when there is a display, else it is an error; it never takes the
// simulated hand.
#include "app/exploration/device_choice.h"

#include <utility>

#include "app/exploration/devices.h"
#include "app/exploration/tour.h"
#include "base/error.h"
#include "haptics/device/falcon/falcon.h"
#include "haptics/device/simulated/simulated_device.h"
#include "haptics/replay/path_device.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace {

constexpr std::uint64_t kSeed = 1;  // of the simulated round: every run feels the same
const std::string kPlayback = "playback:";

ChosenDevice played(const std::string& file) {
  ChosenDevice chosen;
  auto recording = std::make_shared<const haptics::Recording>(file);
  // A path of the hand alone is rendered anew, as if the hand were there.
  if (recording->windows().empty())
    chosen.device = haptics::make_path_device(std::move(recording));
  else
    chosen.recording = std::move(recording);
  return chosen;
}

std::string automatic(bool window) {
  if (!haptics::falcon::find_falcons().empty()) return "falcon";
  if (window) return "pointer";
  throw Error(ErrorKind::device, {}, "no Falcon is connected and there is no window for the pointer",
              "--device keys (at a terminal), falcon, pointer (needs a window), simulated or playback:FILE");
}

}  // namespace

ChosenDevice choose_device(const std::string& name, haptics::DeviceRequest request) {
  if (name.starts_with(kPlayback)) return played(name.substr(kPlayback.size()));
  ChosenDevice chosen;
  chosen.simulated = name == "simulated";
  if (chosen.simulated) return chosen;
  const std::string named = name == "auto" ? automatic(request.window) : name;
  if (named == "pointer")
    request.pointer = chosen.pointer = std::make_shared<haptics::Seqlock<haptics::PointerSample>>();
  if (named == "keys") request.keys = chosen.keys = std::make_shared<haptics::Seqlock<haptics::SteeringSample>>();
  chosen.device = make_device(named, std::move(request));
  return chosen;
}

std::unique_ptr<haptics::Device> simulated_hand(const scene::SceneDescription& scene, double duration_s) {
  return haptics::make_simulated_device(kSeed, duration_s, tour_of(scene));
}

}  // namespace sparsha::app
