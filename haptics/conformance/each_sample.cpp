#include "haptics/conformance/each_sample.h"

#include <algorithm>
#include <cstdint>

#include "base/error.h"
#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr double kGone_s = 1.0;

}  // namespace

void each_sample(Device& device, const std::function<bool(const DeviceSample& sample, double time_s)>& each) {
  const bool paced = device.info().paced;
  const std::int64_t start_ns = now_ns();
  const auto now_s = [start_ns] { return 1e-9 * static_cast<double>(now_ns() - start_ns); };
  double connected_s = 0.0;
  for (std::int64_t tick = 1;; ++tick) {
    if (paced) device.wait(kPeriod_s);
    // A wait() that returns at once must not make this spin.
    const auto planned_ns = static_cast<std::int64_t>(1e9 * kPeriod_s * (paced ? 0.25 : 1.0)) * tick;
    sleep_until_ns(std::min(start_ns + planned_ns, now_ns() + 1'000'000));
    const double time_s = now_s();
    const DeviceSample sample = device.read(time_s, kPeriod_s);
    device.write(Eigen::Vector3d::Zero());
    if (sample.connected) connected_s = time_s;
    if (time_s - connected_s > kGone_s)
      throw Error(ErrorKind::device, {}, device.info().name + ": it is not connected, or has not answered for a second",
                  "its power supply and cable plugged in");
    if (!each(sample, time_s) || sample.finished) return;
  }
}

}  // namespace sparsha::haptics
