// The servo on the device's timing, with faults between them.
#include "haptics/conformance/conformance.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "haptics/servo/servo.h"
#include "haptics/surface/monge_surface.h"

namespace sparsha::haptics {
namespace {

using Result = ConformanceStep::Result;

constexpr double kAir_m = 0.01, kStone_m = -0.002;
constexpr double kLongest_s = 5.0;  // for a touch to come about
constexpr double kFelt_n = 0.1;
constexpr double kPause_s = 0.3;  // a fault goes on so long
constexpr std::chrono::milliseconds kLook{1};
constexpr double kSlack_s = 0.002;  // of threads that wake late

struct Trial {
  Fault fault;
  const char* name;
  const char* what;
  bool pauses;            // one call of the device takes long
  bool may_push = false;  // the hand is where it is said to be: the force goes on
};

constexpr Trial kTrials[] = {
    {Fault::early, "early", "wait() returns at once, with positions that are said to be new", false},
    {Fault::dead, "dead", "wait() returns at once, and nothing is new", false},
    {Fault::silent, "silent", "nothing new comes", false},
    {Fault::late, "late", "one call comes back later than the servo's patience", true},
    {Fault::hangs, "hangs", "one call comes back 0.3 s later than that", true},
    {Fault::not_a_number, "no number", "a coordinate is no number", false},
    {Fault::infinite, "infinite", "a coordinate is infinite", false},
    {Fault::jump, "jump", "the hand is 30 mm aside at once", false},
    {Fault::unplugged, "unplugged", "the device says that it is not connected", false},
    {Fault::stopped, "stopped", "the device says that its positions mean nothing: an emergency stop", false},
    {Fault::loose, "loose", "it is not connected in every other reading", false},
    {Fault::own_clock, "own clock", "its times run nine times too fast, and the hand is 30 mm aside at once", false},
    {Fault::no_time, "no time", "its times are no numbers", false, true},
    {Fault::lies, "lies", "delay, share of the force and force on the motors cannot be", false, true},
    {Fault::stuck, "stuck", "one write() comes back 0.3 s later than the servo's patience", true},
    {Fault::ended, "ended", "no more positions will come", false},
    {Fault::trembles, "trembles", "each position is 1 mm from the one before", false, true},
};

HapticWindow plane() {
  SurfaceParts parts;
  parts.lattice.nx = parts.lattice.ny = 11;
  parts.lattice.spacing_m = 0.01;
  parts.height_m.assign(parts.lattice.count(), 0.0F);
  HapticWindow window;
  window.surface = make_surface(std::move(parts));
  return window;
}

bool wait_for(const std::function<bool()>& so, double longest_s) {
  const auto began = std::chrono::steady_clock::now();
  while (!so()) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > longest_s) return false;
    std::this_thread::sleep_for(kLook);
  }
  return true;
}

/// Up into the air and down into the stone until it is felt. A machine that is late takes the force away: again.
bool touch(FaultyDevice& device) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    device.move_to(kAir_m);
    static_cast<void>(wait_for([&] { return device.height_m() > 0.9 * kAir_m; }, kLongest_s));
    std::this_thread::sleep_for(std::chrono::milliseconds(80));  // the governor arms after 50 ms
    device.move_to(kStone_m);
    if (wait_for([&] { return device.height_m() < 0.9 * kStone_m && device.force_n() > kFelt_n; }, 0.5)) return true;
  }
  return false;
}

/// After so long without news the force is over.
double stale_s(const DeviceInfo& info, const ConformanceOptions& options) {
  const double pace_s =
      info.rate_hz > 0.0 ? std::max(1.0 / info.rate_hz, 1.0 / options.rate_hz) : 1.0 / options.rate_hz;
  return stale_after_s(std::max(pace_s, info.paced ? 0.002 : 0.0));
}

/// What others see and a recording keeps.
bool is_told(const State& state) {
  return std::isfinite(state.time_s) && std::isfinite(state.given_share) &&
         std::all_of(state.commanded_force_n.begin(), state.commanded_force_n.end(),
                     [](double newtons) { return std::isfinite(newtons); });
}

ConformanceStep judge(const Trial& trial, const FaultyDevice& device, const Felt& felt, bool back, double most_s,
                      std::uint64_t most_reads) {
  ConformanceStep step{trial.name, Result::passed, "", ""};
  step.found = fmt::format("{}: no force after {:.1f} ms, {:.2f} N at most, {}", trial.what, 1e3 * felt.last_force_s,
                           felt.strongest_n, back ? "felt again after the air" : "never felt again");
  const double limit_n = usable(device.info().limits).max_force_n;
  std::string wrong;
  if (!felt.finite) wrong = "a force that is no number goes to the motors";
  if (felt.strongest_n > limit_n * (1.0 + 1e-9)) wrong = fmt::format("more than the device's {:.1f} N", limit_n);
  if (felt.reads_with_force > most_reads || felt.last_force_s > most_s)
    wrong = fmt::format("the force goes on for {:.1f} ms and {} ticks", 1e3 * felt.last_force_s, felt.reads_with_force);
  if (device.force_n() != 0.0 && !back) wrong = "a force stays on";
  if (wrong.empty() && !back) wrong = "the stone cannot be felt any more once the fault is over";
  if (!wrong.empty()) {
    step.result = Result::failed;
    step.to_a_hand = wrong;
  }
  return step;
}

/// `most_s`, `most_reads`: for how long the force may go on.
ConformanceStep try_one(const Trial& trial, Device& inner, const ConformanceOptions& options) {
  const DeviceInfo info = inner.info();
  if ((trial.fault == Fault::jump || trial.fault == Fault::own_clock) && !(info.fastest_m_per_s > 0.0))
    return {trial.name, Result::skipped, "any position of this device is believed (fastest_m_per_s is 0)", ""};
  if ((trial.fault == Fault::early || trial.fault == Fault::dead) && !info.paced)
    return {trial.name, Result::skipped, "the servo's clock is this device's pace", ""};
  FaultyDevice device(inner, options.with_force, options.patience_s);
  Seqlock<State> state;
  ServoOptions servo_options;
  servo_options.renderer.rate_hz = options.rate_hz;
  servo_options.renderer.longest_gap_s = options.patience_s;
  Servo servo(device, servo_options, plane(), state, {}, nullptr);
  servo.start();
  if (!touch(device)) {
    servo.stop();
    return {trial.name, Result::skipped,
            "no force came about in four attempts: this machine or this device is too late", "no force"};
  }
  device.inject(trial.fault);
  std::this_thread::sleep_for(
      std::chrono::duration<double>(kPause_s + (trial.pauses ? 2.0 * options.patience_s : 0.0)));
  const Felt felt = device.felt();
  const bool told = is_told(state.read());
  device.inject(Fault::none);
  const bool back = touch(device);
  servo.stop();
  const double period_s = 1.0 / options.rate_hz;
  const double stale = stale_s(info, options);
  double most_s = 1e9;
  std::uint64_t most_reads = 0;
  if (trial.fault == Fault::early) most_reads = 12;  // Pace takes two periods of answers that come at once
  if (trial.fault == Fault::silent || trial.fault == Fault::dead) {
    most_s = stale + 3.0 * period_s + options.patience_s;
    most_reads = static_cast<std::uint64_t>(Pace::kMostTicksPerPeriod * most_s / period_s);
  }
  if (trial.pauses) most_reads = 2;  // the tick under way when it was asked for, and that which sees the pause
  if (trial.pauses) most_s = options.patience_s + 3.0 * period_s + kSlack_s + 0.5 * options.patience_s;
  if (trial.may_push) most_reads = std::numeric_limits<std::uint64_t>::max();
  ConformanceStep step = judge(trial, device, felt, back, most_s, most_reads);
  if (told || step.result != Result::passed) return step;
  return {step.name, Result::failed, step.found, "what is shown and recorded is no number"};
}

}  // namespace

bool ConformanceReport::passed() const {
  return std::none_of(steps.begin(), steps.end(),
                      [](const ConformanceStep& step) { return step.result == ConformanceStep::Result::failed; });
}

const char* name_of(Fault fault) {
  for (const Trial& trial : kTrials)
    if (trial.fault == fault) return trial.name;
  return "none";
}

std::vector<ConformanceStep> try_faults(Device& device, const ConformanceOptions& options) {
  std::vector<ConformanceStep> steps;
  for (const Trial& trial : kTrials) {
    const auto& wanted = options.faults;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), trial.fault) == wanted.end()) continue;
    if (options.stop && options.stop())
      steps.push_back({trial.name, Result::skipped, "stopped", ""});
    else
      steps.push_back(try_one(trial, device, options));
  }
  return steps;
}

ConformanceReport check_conformance(const std::shared_ptr<Device>& device, const ConformanceOptions& options) {
  ConformanceReport report;
  report.steps = watch_device(device, options);
  // A device of which a call never returned cannot be asked again.
  const bool returns = report.steps.size() > 2;
  if (!returns) return report;
  for (ConformanceStep& step : try_faults(*device, options)) report.steps.push_back(std::move(step));
  return report;
}

}  // namespace sparsha::haptics
