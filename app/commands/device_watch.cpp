#include "app/commands/device_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/terminal/terminal.h"
#include "app/words/results.h"
#include "base/error.h"
#include "base/phrases/phrases.h"
#include "haptics/conformance/conformance.h"
#include "haptics/conformance/each_sample.h"

namespace sparsha::app {
namespace {

using Json = nlohmann::ordered_json;
using Step = haptics::CheckStep;

constexpr double kHomingTime_s = 60.0;
constexpr double kLine_s = 0.1;

/// What a line of the monitor sums up since the one before.
struct Since {
  double time_s = 0.0;
  std::uint64_t answers = 0;
  double longest_s = 0.0;
  [[nodiscard]] double rate_hz(double now_s) const {
    return static_cast<double>(answers) / std::max(1e-3, now_s - time_s);
  }
};

std::string held_buttons(std::uint64_t buttons) {
  static constexpr const char* kNames[] = {"right", "front", "centre", "left"};
  std::string text;
  for (unsigned bit = 0; bit < 4; ++bit)
    if ((buttons >> bit & 1U) != 0) text += fmt::format("{}{}", text.empty() ? "" : "+", kNames[bit]);
  return text.empty() ? "none" : text;
}

std::string line_of(const haptics::DeviceSample& sample, double time_s, const Since& since,
                    const CommonOptions& common) {
  const Eigen::Vector3d mm = sample.position_m * 1e3;
  const char* const homed = sample.homed ? "homed" : "not homed";
  if (common.json)
    return Json{{"t_s", time_s},
                {"position_m", {sample.position_m.x(), sample.position_m.y(), sample.position_m.z()}},
                {"homed", sample.homed},
                {"buttons", held_buttons(sample.buttons)},
                {"rate_hz", since.rate_hz(time_s)},
                {"longest_ms", since.longest_s * 1e3}}
        .dump();
  if (common.plain)
    return fmt::format(
        "After {:.1f} seconds the grip is at {:.0f}, {:.0f} and {:.0f} millimetres, it is {}, and of its buttons {} "
        "held.",
        time_s, mm.x(), mm.y(), mm.z(), homed, sample.buttons == 0 ? "none is" : held_buttons(sample.buttons) + " are");
  return fmt::format("{:8.2f} s  {:7.2f} {:7.2f} {:7.2f} mm  {:<9}  buttons {:<8} {:4.0f} answers/s, longest {:.2f} ms",
                     time_s, mm.x(), mm.y(), mm.z(), homed, held_buttons(sample.buttons), since.rate_hz(time_s),
                     since.longest_s * 1e3);
}

Step step_of(const haptics::ConformanceStep& step) {
  return {step.name, static_cast<Step::Result>(step.result), step.found,
          step.to_a_hand.empty() ? "" : "at a hand: " + step.to_a_hand};
}
static_assert(static_cast<int>(haptics::ConformanceStep::Result::failed) == static_cast<int>(Step::Result::failed) &&
              static_cast<int>(haptics::ConformanceStep::Result::skipped) == static_cast<int>(Step::Result::skipped));

void add(haptics::CheckReport& report, const std::vector<haptics::ConformanceStep>& steps) {
  for (const haptics::ConformanceStep& step : steps) report.steps.push_back(step_of(step));
}

}  // namespace

int monitor_device(haptics::Device& device, const CommonOptions& common, double duration_s) {
  Since since;
  double fresh_s = 0.0;
  haptics::each_sample(device, [&](const haptics::DeviceSample& sample, double time_s) {
    if (sample.fresh) {
      ++since.answers;
      since.longest_s = std::max(since.longest_s, time_s - fresh_s);
      fresh_s = time_s;
    }
    if (time_s >= since.time_s + kLine_s) {
      print(line_of(sample, time_s, since, common));
      flush_output();  // live, and over when nobody reads any more
      since = {time_s, 0, 0.0};
    }
    return !interrupted() && (duration_s <= 0.0 || time_s < duration_s);
  });
  return 0;
}

int home_device(haptics::Device& device, const CommonOptions& common, const std::function<void(const char*)>& say) {
  bool homed = false;
  const haptics::DeviceAdvice* told = nullptr;
  haptics::each_sample(device, [&](const haptics::DeviceSample& sample, double time_s) {
    homed = sample.homed && sample.connected && sample.fresh;
    const haptics::DeviceAdvice* const advice = device.advice();
    if (!homed && advice != nullptr && advice != told) say(advice->phrase);
    told = advice;
    return !homed && !interrupted() && time_s < kHomingTime_s;
  });
  const std::string name = device.info().name;
  if (homed) {
    print(common.json ? "{\"homed\": true}" : common.plain ? "The device " + name + " is homed." : "homed");
    return 0;
  }
  if (interrupted()) throw Cancelled();
  const std::string says = told == nullptr ? "" : ": " + Phrases::of("en").text_or(told->phrase);
  throw Error(ErrorKind::device, {}, name + " did not home within a minute" + says,
              "a device that is moved, or set up, as it says");
}

haptics::CheckReport check_device(const haptics::DeviceKind& kind, const haptics::DeviceRequest& request,
                                  const CheckWish& wish) {
  haptics::CheckReport report;
  if (kind.check) {
    report = kind.check(request, wish.seconds);
    if (!wish.conformance || !report.passed()) return report;
  }
  std::shared_ptr<haptics::Device> device;
  try {
    device = kind.make(request);
    report.steps.push_back({"opening", Step::Result::passed, device->info().name, ""});
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    report.steps.push_back({"opening", Step::Result::failed, error.wrong(), error.expected()});
    return report;
  }
  haptics::ConformanceOptions options;
  options.watch_s = kind.check ? 2.0 : wish.seconds;
  options.stop = request.stop;
  if (wish.conformance)
    add(report, check_conformance(device, options).steps);
  else
    add(report, watch_device(device, options));
  return report;
}

}  // namespace sparsha::app
