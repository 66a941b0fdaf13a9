#include "haptics/device/falcon/kind.h"

#include <fmt/format.h>

#include "haptics/device/falcon/check.h"

namespace sparsha::haptics::falcon {

FalconOptions options_of(const DeviceRequest& request) {
  FalconOptions options;
  options.firmware = request.firmware;
  options.wait_for_device = request.wait_for_device;
  options.stop = request.stop;
  options.say = request.say;
  return options;
}

DeviceKind falcon_kind() {
  const auto find = [](const DeviceRequest&) {
    std::vector<FoundDevice> result;
    for (const FoundFalcon& one : find_falcons())
      result.push_back({fmt::format("bus {} address {}", one.bus, one.address),
                        one.accessible,
                        one.problem,
                        {{"bus", one.bus}, {"address", one.address}}});
    if (result.empty()) result.push_back({"", false, "none is connected", {}});
    return result;
  };
  return {"falcon",
          nullptr,
          "`sparsha device check` tests it",
          find,
          [](const DeviceRequest& request) { return make_falcon_device(options_of(request)); },
          [](const DeviceRequest& request, double seconds) { return check_falcon(options_of(request), seconds); }};
}

}  // namespace sparsha::haptics::falcon
