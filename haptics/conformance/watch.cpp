// The device by itself, called as the servo calls it.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "base/phrases/phrases.h"
#include "haptics/conformance/conformance.h"
#include "haptics/conformance/repeat_watch.h"
#include "haptics/servo/pace.h"
#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {

using Result = ConformanceStep::Result;

constexpr double kGivenUp_s = 1.0;        // a call that has not returned by then
constexpr double kLongestCall_s = 0.001;  // of those that must not block
constexpr double kUnlikely_m_per_s = 20.0;
constexpr double kMostForce_n = 50.0;
constexpr std::uint64_t kZeroEvery = 64;

/// What a thread saw of the device; the thread may outlive whoever asked.
struct Watched {
  std::atomic<const char*> in_call{""};
  std::atomic<std::uint64_t> beats{0};
  std::atomic<bool> done{false}, give_up{false};
  double duration_s = 0.0;
  std::uint64_t ticks = 0, runaway = 0, fresh = 0, not_finite = 0, jumps = 0, outside = 0, bad_times = 0,
                bad_delays = 0;
  std::uint64_t unhomed = 0, disconnected = 0;
  double longest_step_m = 0.0;
  RepeatWatch news;
  std::vector<double> gaps_s, read_s, write_s, zero_s;
};

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// Judges positions as they come.
class Positions {
 public:
  explicit Positions(const DeviceInfo& info)
      : info_(info), speed_(info.fastest_m_per_s > 0.0 ? info.fastest_m_per_s : kUnlikely_m_per_s) {}

  void see(const DeviceSample& sample, double asked_s, double period_s, Watched& seen) {
    if (!sample.connected) ++seen.disconnected;
    if (sample.connected && !sample.homed) ++seen.unhomed;
    const bool apart = !(info_.rate_hz > 0.0 && !info_.paced) && std::abs(sample.time_s - asked_s) > 0.1;
    if (!sample.finished && (!std::isfinite(sample.time_s) || sample.time_s < last_time_s_ || apart)) ++seen.bad_times;
    if (std::isfinite(sample.time_s)) last_time_s_ = sample.time_s;
    if (!(sample.delay_s >= 0.0 && sample.delay_s < 0.1)) ++seen.bad_delays;
    if (!sample.position_m.allFinite()) {
      ++seen.not_finite;
    } else if (sample.connected && sample.homed && sample.fresh) {
      if (known_) seen.longest_step_m = std::max(seen.longest_step_m, (sample.position_m - last_m_).norm());
      known_ = true;
      last_m_ = sample.position_m;
      seen.news.see(sample.position_m);
      if (sample.position_m.norm() > 2.0 * info_.workspace_width_m) ++seen.outside;
    }
    if (speed_.jumps(sample, period_s)) ++seen.jumps;
    if (sample.fresh) ++seen.fresh;
  }

 private:
  DeviceInfo info_;
  HandSpeed speed_;
  bool known_ = false;
  double last_time_s_ = -1.0;
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
};

/// One thread, for `watch_s`.
void watch(Device& device, const ConformanceOptions& options, Watched& seen) {
  const DeviceInfo info = device.info();
  const double period_s = 1.0 / options.rate_hz;
  const auto period_ns = static_cast<std::int64_t>(1e9 * period_s);
  Pace pace(period_ns);
  seen.news = RepeatWatch(usable(info.limits).encoder_step_m);
  Positions positions(info);
  static_cast<void>(request_real_time(kServoPriority));
  const std::int64_t start_ns = now_ns();
  std::int64_t last_ns = start_ns;
  while (!seen.give_up.load() && seconds(now_ns() - start_ns) < options.watch_s) {
    seen.in_call.store("wait()");
    if (info.paced)
      device.wait(period_s);
    else
      sleep_until_ns(start_ns + static_cast<std::int64_t>(seen.ticks + 1) * period_ns);
    const std::int64_t woke_ns = now_ns();
    if (seen.ticks > 0) seen.gaps_s.push_back(seconds(woke_ns - last_ns));
    last_ns = woke_ns;
    sleep_until_ns(pace.admit(woke_ns));
    if (info.paced && pace.runs_away()) ++seen.runaway;
    seen.in_call.store("read()");
    const double asked_s = seconds(now_ns() - start_ns);
    const std::int64_t begun_ns = now_ns();
    const DeviceSample sample = device.read(asked_s, period_s);
    const std::int64_t read_ns = now_ns();
    positions.see(sample, asked_s, period_s, seen);
    seen.in_call.store("write()");
    const std::int64_t writes_ns = now_ns();
    device.write(Eigen::Vector3d::Zero());
    const std::int64_t wrote_ns = now_ns();
    seen.read_s.push_back(seconds(read_ns - begun_ns));
    seen.write_s.push_back(seconds(wrote_ns - writes_ns));
    if (seen.ticks % kZeroEvery == 0) {
      seen.in_call.store("zero()");
      device.zero();
      seen.zero_s.push_back(seconds(now_ns() - wrote_ns));
    }
    ++seen.ticks;
    seen.beats.fetch_add(1);
    if (sample.finished) break;
  }
  seen.duration_s = seconds(now_ns() - start_ns);
  seen.done.store(true);
}

ConformanceStep step(std::string name, bool passed, std::string found, std::string to_a_hand) {
  return {std::move(name), passed ? Result::passed : Result::failed, std::move(found),
          passed ? std::string() : std::move(to_a_hand)};
}

ConformanceStep facts(const DeviceInfo& info) {
  std::string wrong;
  const auto check = [&wrong](bool right, const std::string& what) {
    if (!right) wrong += (wrong.empty() ? "" : "; ") + what;
  };
  const DeviceLimits& limits = info.limits;
  check(!info.name.empty(), "it has no name");
  check(info.workspace_width_m >= 0.01 && info.workspace_width_m <= 2.0,
        fmt::format("a workspace of {:.3g} m is none for a hand", info.workspace_width_m));
  check(limits.max_force_n >= 0.0 && limits.max_force_n <= kMostForce_n,
        fmt::format("a force of {:.3g} N is not one for a hand (0 to {:.0f})", limits.max_force_n, kMostForce_n));
  check(limits.least_damping_n_s_per_m >= 0.0 && limits.least_damping_n_s_per_m <= 100.0,
        fmt::format("a damping of {:.3g} N s/m", limits.least_damping_n_s_per_m));
  check(limits.slew_n_per_s > 0.0 && limits.slew_n_per_s <= 1e5,
        fmt::format("a growth of force of {:.3g} N/s", limits.slew_n_per_s));
  check(limits.delay_ticks >= 0 && limits.delay_ticks <= kLongestDelayTicks,
        fmt::format("a delay of {} ticks (0 to {})", limits.delay_ticks, kLongestDelayTicks));
  check(limits.undeclared_s >= 0.0 && limits.undeclared_s <= 0.004,
        fmt::format("an undeclared delay of {:.3g} s (0 to 0.004)", limits.undeclared_s));
  check(info.rate_hz >= 0.0 && info.rate_hz < 1e6, fmt::format("a rate of {:.3g} Hz", info.rate_hz));
  check(info.fastest_m_per_s >= 0.0 && info.fastest_m_per_s < 1e3,
        fmt::format("a fastest hand of {:.3g} m/s", info.fastest_m_per_s));
  const std::string fastest = info.fastest_m_per_s > 0.0
                                  ? fmt::format("no faster than {:.1f} m/s", info.fastest_m_per_s)
                                  : "any position is believed";
  const std::string found = fmt::format("{}: {:.0f} mm, {:.1f} N, {}{}{}", info.name, 1e3 * info.workspace_width_m,
                                        limits.max_force_n, fastest, info.warning.empty() ? "" : "; ", info.warning);
  return step("facts", wrong.empty(), wrong.empty() ? found : wrong,
              "the governor takes the safe end of what is absurd: no force, or none that grows");
}

ConformanceStep pace_of(const DeviceInfo& info, const Watched& seen, const ConformanceOptions& options) {
  const double rate_hz = seen.duration_s > 0.0 ? static_cast<double>(seen.ticks) / seen.duration_s : 0.0;
  const double longest_s = seen.gaps_s.empty() ? 0.0 : *std::max_element(seen.gaps_s.begin(), seen.gaps_s.end());
  const auto late = static_cast<std::uint64_t>(
      std::count_if(seen.gaps_s.begin(), seen.gaps_s.end(), [&](double gap) { return gap > options.patience_s; }));
  std::string found = fmt::format("{:.0f} ticks/s, apart {:.2f} ms (median) and {:.2f} ms at most", rate_hz,
                                  1e3 * quantile(seen.gaps_s, 0.5), 1e3 * longest_s);
  if (!info.paced) return step("pace", true, found + "; the servo's clock is its pace", "");
  if (20 * seen.runaway > seen.ticks)
    return step(
        "pace", false, found + fmt::format("; wait() returned at once in {} of {}", seen.runaway, seen.ticks),
        fmt::format("no force: such a loop is held to {} ticks a period", std::int64_t{Pace::kMostTicksPerPeriod}));
  if (50 * late > seen.ticks)
    return step("pace", false,
                found + fmt::format("; {} of {} later than {:.0f} ms", late, seen.ticks, 1e3 * options.patience_s),
                "the stone goes soft, again and again, until the hand has been in the air");
  return step("pace", true, found, "");
}

ConformanceStep news_of(const Device& device, const DeviceInfo& info, const Watched& seen) {
  const DeviceAdvice* const advice = device.advice();
  const std::string says =
      advice == nullptr ? "" : fmt::format("; it says: {}", Phrases::of("en").text_or(advice->phrase));
  if (seen.fresh == 0 || seen.disconnected > seen.ticks / 2) {
    // A pointer brings news when somebody moves it; a device that sets the pace brings them always.
    const bool gone = seen.disconnected > 0 || info.paced;
    return {"news", gone ? Result::failed : Result::skipped,
            (seen.disconnected > 0 ? "it is not connected" : "nothing new came") + says, "no force"};
  }
  const double rate_hz = static_cast<double>(seen.fresh) / seen.duration_s;
  std::string found = fmt::format("{:.0f} new positions a second{}", rate_hz, says);
  if (advice != nullptr && advice->needed && 2 * seen.unhomed > seen.ticks)
    return {"news", Result::failed, found, "no force before that is done"};
  if (info.limits.max_force_n > 0.0 && 2 * seen.unhomed > seen.ticks)
    return {"news", Result::failed, found + "; its positions mean nothing yet (homed is false)", "no force"};
  if (info.rate_hz > 0.0 && (rate_hz < 0.5 * info.rate_hz || rate_hz > 1.5 * info.rate_hz))
    return step("news", false, found + fmt::format(", and it says {:.0f}", info.rate_hz),
                "a stiffness for another rate: a wall that swings, or one that is too soft");
  const std::size_t repeated = seen.news.repeated();
  if (repeated > 0) found += fmt::format("; {} of {} positions are those of before", repeated, seen.news.seen());
  if (seen.news.repeats())
    return step("news", false, found + ", between moves of a hand that cannot have stood still, and are said to be new",
                "it is taken for a faster device: the wall may give back more than it took, and swing");
  if (repeated > 0 && !seen.news.moves()) found += ": the hand hardly moved, so that nothing can be told of it";
  // Fewer leave the hand stale between two of them.
  const double fewest_hz = 1.0 / stale_after_s(info.rate_hz > 0.0 ? 1.0 / info.rate_hz : 0.0);
  return step("news", rate_hz >= fewest_hz, found, "the force comes and goes: between two positions it is over");
}

ConformanceStep positions_of(const DeviceInfo& info, const Watched& seen) {
  std::string wrong;
  const auto check = [&wrong](std::uint64_t count, const char* what) {
    if (count > 0) wrong += fmt::format("{}{} {}", wrong.empty() ? "" : "; ", count, what);
  };
  check(seen.not_finite, "that are no numbers");
  check(seen.jumps, "that no hand can have come to");
  check(seen.outside, "far outside the workspace");
  check(seen.bad_times, "of another clock than the servo's");
  check(seen.bad_delays, "with a delay that cannot be");
  std::string found = fmt::format("longest step {:.2f} mm", 1e3 * seen.longest_step_m);
  if (seen.unhomed > 0) found += fmt::format("; {} before it was homed", seen.unhomed);
  if (wrong.empty()) return step("positions", true, found, "");
  const bool checked = info.fastest_m_per_s > 0.0 || seen.jumps == 0;
  return step("positions", false, wrong + "; " + found,
              checked ? "the force ends at each of them until the hand has been in the air"
                      : "a blow: the servo believes every position of this device (fastest_m_per_s is 0)");
}

ConformanceStep calls_of(const Watched& seen) {
  const double read_s = quantile(seen.read_s, 0.99), write_s = quantile(seen.write_s, 0.99);
  const double zero_s = quantile(seen.zero_s, 0.9);
  return step("calls", std::max({read_s, write_s, zero_s}) < kLongestCall_s,
              fmt::format("read() {:.1f} us, write() {:.1f} us (99 of 100), zero() {:.1f} us (9 of 10)", 1e6 * read_s,
                          1e6 * write_s, 1e6 * zero_s),
              "forces that come late: the wall swings");
}

}  // namespace

std::vector<ConformanceStep> watch_device(const std::shared_ptr<Device>& device, const ConformanceOptions& options) {
  const DeviceInfo info = device->info();
  std::vector<ConformanceStep> steps{facts(info)};
  auto seen = std::make_shared<Watched>();
  std::thread thread([device, options, seen] { watch(*device, options, *seen); });
  std::uint64_t beats = 0;
  std::int64_t heard_ns = now_ns();
  while (!seen->done.load() && seconds(now_ns() - heard_ns) < kGivenUp_s) {
    if (const std::uint64_t now = seen->beats.load(); now != beats) {
      beats = now;
      heard_ns = now_ns();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!seen->done.load()) {
    seen->give_up.store(true);
    thread.detach();
    steps.push_back({"calls", Result::failed,
                     fmt::format("{} has not returned for {:.0f} s", seen->in_call.load(), kGivenUp_s),
                     "the watchdog ends the force by zero(); nothing else goes on"});
    return steps;
  }
  thread.join();
  steps.push_back(pace_of(info, *seen, options));
  steps.push_back(news_of(*device, info, *seen));
  steps.push_back(positions_of(info, *seen));
  steps.push_back(calls_of(*seen));
  return steps;
}

}  // namespace sparsha::haptics
