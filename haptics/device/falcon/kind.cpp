#include "haptics/device/falcon/kind.h"

#include <fmt/format.h>

#include "base/error.h"
#include "haptics/device/falcon/calibration.h"
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

namespace {

CalibrationReport calibrate_kind(const DeviceRequest& request, double weight_n) {
  require_calibration_place();
  CalibrationOptions options;
  options.weight_n = weight_n;
  FalconOptions usual = options_of(request);
  usual.counts_per_newton_metre = options.counts_per_newton_metre;
  const auto device = make_falcon_device(usual);
  const auto say = request.say ? request.say : [](const std::string&) {};
  const auto found = calibrate(*device, options, say, request.stop);
  if (!found) throw Error(ErrorKind::failure, {}, "calibration: stopped", "all steps taken");
  const double scale = found->counts_per_newton_metre;
  store_calibration(scale);
  const double error = scale * found->scatter_n / (found->loaded_n - found->empty_n);
  return {{{"counts_per_newton_metre", scale},
           {"weight_n", found->weight_n},
           {"empty_n", found->empty_n},
           {"loaded_n", found->loaded_n},
           {"standard_error_n", found->scatter_n}},
          fmt::format("{:.0f} motor counts per newton metre (+- {:.0f})", scale, error),
          fmt::format("The scale is {:.0f} motor counts per newton metre, give or take {:.0f}.", scale, error),
          calibration_file()};
}

}  // namespace

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
          [](const DeviceRequest& request, double seconds) { return check_falcon(options_of(request), seconds); },
          calibrate_kind};
}

}  // namespace sparsha::haptics::falcon
