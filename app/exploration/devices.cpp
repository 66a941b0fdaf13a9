#include "app/exploration/devices.h"

#include <utility>
#include <vector>

#include "base/error.h"
#include "haptics/device/falcon/kind.h"
#include "haptics/device/gamepad/gamepad.h"
#include "haptics/device/haply/haply.h"
#include "haptics/device/plugin/plugin.h"
#include "haptics/device/pointer/kind.h"
#include "haptics/device/simulated/simulated_device.h"
#include "haptics/device/steered/kind.h"
#include "haptics/replay/path_device.h"

namespace sparsha::app {
namespace {

constexpr std::uint64_t kSeed = 1;

// What other programs embed of the simulated hand knows nothing of kinds.
haptics::DeviceKind simulated_kind() {
  return {"simulated",
          nullptr,
          "a seeded hand explores by itself",
          [](const haptics::DeviceRequest&) -> std::vector<haptics::FoundDevice> {
            return {{"", true, "", {}}};
          },
          [](const haptics::DeviceRequest&) { return haptics::make_simulated_device(kSeed, 0.0); },
          {}};
}

// A recording's path of the hand; `explore` also repeats its windows and words.
haptics::DeviceKind playback_kind() {
  return {"playback",
          "FILE",
          "playback:FILE repeats a recorded run.csv",
          [](const haptics::DeviceRequest&) -> std::vector<haptics::FoundDevice> {
            return {{"", true, "", {}}};
          },
          [](const haptics::DeviceRequest& request) {
            return haptics::make_path_device(std::make_shared<const haptics::Recording>(request.argument));
          },
          {}};
}

std::string spelled(const haptics::DeviceKind& kind) {
  return kind.argument == nullptr ? kind.name : std::string(kind.name) + ":" + kind.argument;
}

}  // namespace

std::span<const haptics::DeviceKind> device_kinds() {
  static const std::vector<haptics::DeviceKind> kinds{
      haptics::falcon::falcon_kind(),  //
      haptics::haply::haply_kind(),    //
      haptics::plugin::plugin_kind(),  //
      haptics::pointer_kind(),         //
      haptics::steered_kind(),         //
      haptics::gamepad_kind(),         //
      haptics::tablet_kind(),          //
      simulated_kind(),                //
      playback_kind(),                 //
  };
  return kinds;
}

std::string named_devices() {
  std::string names;
  for (const haptics::DeviceKind& kind : device_kinds()) names += (names.empty() ? "" : " | ") + spelled(kind);
  return names;
}

std::string device_names() { return "auto | " + named_devices(); }

NamedKind kind_of(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string first = name.substr(0, colon);
  const std::string argument = colon == std::string::npos ? "" : name.substr(colon + 1);
  for (const haptics::DeviceKind& kind : device_kinds()) {
    if (first != kind.name) continue;
    const bool takes_one = kind.argument != nullptr;
    const bool needs_one = takes_one && kind.argument[0] != '[';
    if ((needs_one && argument.empty()) || (!takes_one && colon != std::string::npos)) break;
    return {&kind, argument};
  }
  throw usage_error("there is no device '" + name + "' here", named_devices());
}

void require_use_of_firmware(const std::string& device, const std::string& firmware) {
  static const std::string falcon = haptics::falcon::falcon_kind().name;
  if (firmware.empty() || device == "auto" || kind_of(device).kind->name == falcon) return;
  throw usage_error("--firmware means nothing here", "--device falcon with it");
}

std::unique_ptr<haptics::Device> make_device(const std::string& name, haptics::DeviceRequest request) {
  NamedKind named = kind_of(name);
  request.argument = std::move(named.argument);
  return named.kind->make(request);
}

}  // namespace sparsha::app
