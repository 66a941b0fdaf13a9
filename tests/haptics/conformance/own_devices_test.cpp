// Every device of ours that needs no emulator, in the harness that stands for any driver. Haply, Falcon and plug-ins
// are tried beside their emulators (tests/haptics/device).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/system/gamepad.h"
#include "haptics/conformance/conformance.h"
#include "haptics/device/gamepad/gamepad.h"
#include "haptics/device/pointer/pointer_device.h"
#include "haptics/device/simulated/simulated_device.h"
#include "haptics/device/steered/steered_device.h"
#include "haptics/replay/path_device.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

/// Nobody touches it.
class RestingPad final : public system::Pad {
 public:
  [[nodiscard]] std::string name() const override { return "resting"; }
  void read(system::PadState& state) noexcept override { state = {}; }
  bool rumble(double, double, double) noexcept override { return true; }
};

struct OwnDevice {
  const char* name;
  std::function<std::unique_ptr<Device>()> make;
};

/// Ten seconds of a hand that goes round.
std::unique_ptr<Device> played() {
  const sparsha::test::TestFolder folder;
  std::ofstream run(folder / "run.csv");
  run << "t_s,device_x_m,device_y_m,device_z_m\n";
  for (int row = 0; row < 10'000; ++row)
    run << 1e-3 * row << ',' << 0.01 * std::sin(0.01 * row) << ',' << 0.01 * std::cos(0.01 * row) << ",0.01\n";
  run.close();
  return make_path_device(std::make_shared<const Recording>(folder / "run.csv"));
}

class OwnDevices : public testing::TestWithParam<OwnDevice> {};

TEST_P(OwnDevices, ConformAndLeaveNoForceAfterAnyFault) {
  const std::shared_ptr<Device> device = GetParam().make();
  ConformanceOptions options;
  options.watch_s = 0.3;
  options.patience_s = 0.3;
  for (const ConformanceStep& step : watch_device(device, options))
    EXPECT_NE(step.result, ConformanceStep::Result::failed) << step.name << ": " << step.found << step.to_a_hand;
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) options.faults = {Fault::stopped};
  for (const ConformanceStep& step : try_faults(*device, options))
    EXPECT_NE(step.result, ConformanceStep::Result::failed) << step.name << ": " << step.found << step.to_a_hand;
}

INSTANTIATE_TEST_SUITE_P(
    Each, OwnDevices,
    testing::Values(
        OwnDevice{"simulated", [] { return make_simulated_device(1, 0.0); }},
        OwnDevice{"pointer", [] { return make_pointer_device(std::make_shared<Seqlock<PointerSample>>()); }},
        OwnDevice{"keys", [] { return make_steered_device(std::make_shared<Seqlock<SteeringSample>>()); }},
        OwnDevice{"gamepad", [] { return make_pad_device(std::make_unique<RestingPad>(), system::PadKind::gamepad); }},
        OwnDevice{"tablet", [] { return make_pad_device(std::make_unique<RestingPad>(), system::PadKind::tablet); }},
        OwnDevice{"playback", [] { return played(); }}),
    [](const testing::TestParamInfo<OwnDevice>& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace sparsha::haptics
