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

constexpr double kTouch_n_per_m = 100.0;   // a wall that no loop has to make softer
constexpr double kStiff_n_per_m = 4000.0;  // one that every loop has to make softer
constexpr double kSame = 0.05;             // of a force: no difference
constexpr double kMostDelivered_j = 0.010;

/// What the servo may do while a fault goes on.
enum class May : std::uint8_t {
  end,    // no force but what is on its way
  hold,   // the hand rests: the force of a loop as planned, or a softer one, that does not shake
  go_on,  // nothing that is felt is wrong: the force of before
};

struct Trial {
  Fault fault;
  const char* name;
  const char* what;
  bool pauses;  // one call of the device takes long
  May may = May::end;
  double wish_n_per_m = RendererOptions().stiffness_n_per_m;
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
    {Fault::no_time, "no time", "its times are no numbers", false, May::go_on, kTouch_n_per_m},
    {Fault::lies, "lies", "delay, share of the force and force on the motors cannot be", false, May::hold,
     kStiff_n_per_m},
    {Fault::hasty, "hasty", "a force is said to be at the hand at once, or before it was written", false, May::hold,
     kStiff_n_per_m},
    {Fault::stuck, "stuck", "one write() comes back 0.3 s later than the servo's patience", true},
    {Fault::ended, "ended", "no more positions will come", false},
    {Fault::trembles, "trembles", "each position is 1 mm from the one before", false},
    {Fault::repeats, "repeats", "it looks at the hand a hundred times a second, and says each time that this is new",
     false, May::hold, kStiff_n_per_m},
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
bool touch(FaultyDevice& device, double felt_n = kFelt_n) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    device.move_to(kAir_m);
    static_cast<void>(wait_for([&] { return device.height_m() > 0.9 * kAir_m; }, kLongest_s));
    std::this_thread::sleep_for(std::chrono::milliseconds(80));  // the governor arms after 50 ms
    device.move_to(kStone_m);
    if (wait_for([&] { return device.height_m() < 0.9 * kStone_m && device.force_n() > felt_n; }, 0.5)) return true;
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

/// What a trial saw.
struct Seen {
  DeviceInfo info;
  Felt felt;              // while the fault went on
  double before_n = 0.0;  // at rest in the stone
  double then_n = 0.0;    // at rest in the stone after strokes through the air, while the fault goes on
  bool late = false;      // this machine was, and took the force away
  bool back = false;      // felt again after the air
  bool held = false;      // a force is on now
  bool told = true;       // what others see is numbers
};

/// docs/touch.md, "Governor", 2: of a device that measures no delay, in a loop as planned, or one of `period_s`.
double firmest_n(const Seen& seen, double period_s) {
  const DeviceLimits limits = usable(seen.info.limits);
  const double delay_s = std::max(0.001, limits.delay_ticks * period_s);
  const double limit_n_per_m = 0.8 * limits.least_damping_n_s_per_m / (0.5 * period_s + delay_s);
  return std::min(limits.max_force_n, std::min(kStiff_n_per_m, limit_n_per_m) * -kStone_m);
}

/// What is wrong with what is felt while a fault goes on; empty: nothing.
std::string wrong_force(May may, const Seen& seen, const ConformanceOptions& options) {
  const Felt& felt = seen.felt;
  // A wall of looks that are 10 ms apart gives energy by design, which the least damping of hand and device takes.
  const double damped_j =
      seen.then_n > 0.0 ? usable(seen.info.limits).least_damping_n_s_per_m * felt.square_m2_per_s : 0.0;
  if (felt.delivered_j > kMostDelivered_j + damped_j)
    return fmt::format("a hand gets {:.0f} mJ in {:.1f} s", 1e3 * felt.delivered_j, kPause_s);
  if (may == May::hold) {
    const double most_n = (1.0 + kSame) * firmest_n(seen, 1.0 / options.rate_hz);
    if (felt.strongest_n > most_n)
      return fmt::format("the wall is stiffer than without a measured delay: {:.2f} N instead of {:.2f} N",
                         felt.strongest_n, most_n);
    if (felt.shaken_n > kSame * felt.strongest_n)
      return fmt::format("the force shakes by {:.2f} N from tick to tick", felt.shaken_n);
  }
  if (seen.then_n > (1.0 + kSame) * firmest_n(seen, kRepeat_s))
    return fmt::format("the wall is that of a fast device, {:.2f} N instead of {:.2f} N", seen.then_n,
                       firmest_n(seen, kRepeat_s));
  if (may == May::go_on && felt.strongest_n > (1.0 + kSame) * seen.before_n)
    return fmt::format("the force grows from {:.2f} to {:.2f} N", seen.before_n, felt.strongest_n);
  if (may == May::go_on && !seen.late && felt.weakest_n < (1.0 - kSame) * seen.before_n)
    return fmt::format("the force falls from {:.2f} to {:.2f} N", seen.before_n, felt.weakest_n);
  return {};
}

std::string found_in(const Trial& trial, const Seen& seen) {
  const Felt& felt = seen.felt;
  std::string found = std::string(trial.what) + ": ";
  if (trial.may == May::end) found += fmt::format("no force after {:.1f} ms, ", 1e3 * felt.last_force_s);
  if (trial.may == May::hold || trial.may == May::go_on)
    found += fmt::format("{:.2f} N before, {:.2f} N and more then, ", seen.before_n, felt.weakest_n);
  return found + fmt::format("{:.2f} N and {:.1f} mJ at most, {}{}", felt.strongest_n, 1e3 * felt.delivered_j,
                             seen.back ? "felt again after the air" : "never felt again",
                             seen.late ? "; this machine was late" : "");
}

/// `most_s`, `most_reads`: for how long a force that is to end may go on.
ConformanceStep judge(const Trial& trial, const Seen& seen, double most_s, std::uint64_t most_reads,
                      const ConformanceOptions& options) {
  ConformanceStep step{trial.name, Result::passed, found_in(trial, seen), ""};
  const Felt& felt = seen.felt;
  const double limit_n = usable(seen.info.limits).max_force_n;
  std::string wrong = wrong_force(trial.may, seen, options);
  if (!felt.finite) wrong = "a force that is no number goes to the motors";
  if (felt.strongest_n > limit_n * (1.0 + 1e-9)) wrong = fmt::format("more than the device's {:.1f} N", limit_n);
  if (trial.may == May::end && (felt.reads_with_force > most_reads || felt.last_force_s > most_s))
    wrong = fmt::format("the force goes on for {:.1f} ms and {} ticks", 1e3 * felt.last_force_s, felt.reads_with_force);
  if (seen.held && !seen.back) wrong = "a force stays on";
  if (wrong.empty() && !seen.back) wrong = "the stone cannot be felt any more once the fault is over";
  if (wrong.empty() && !seen.told) wrong = "what is shown and recorded is no number";
  if (wrong.empty()) return step;
  step.result = Result::failed;
  step.to_a_hand = wrong;
  return step;
}

/// For how long a force may go on that is to end.
ConformanceStep judge(const Trial& trial, const Seen& seen, const ConformanceOptions& options) {
  const double period_s = 1.0 / options.rate_hz;
  double most_s = 1e9;
  std::uint64_t most_reads = 0;
  if (trial.fault == Fault::early) most_reads = 12;  // Pace takes two periods of answers that come at once
  if (trial.fault == Fault::silent || trial.fault == Fault::dead) {
    most_s = stale_s(seen.info, options) + 3.0 * period_s + options.patience_s;
    most_reads = static_cast<std::uint64_t>(Pace::kMostTicksPerPeriod * most_s / period_s);
  }
  if (trial.fault == Fault::trembles) most_reads = 10;  // HandSpeed takes a few turns
  if (trial.pauses) most_reads = 2;  // the tick under way when it was asked for, and that which sees the pause
  if (trial.pauses) most_s = options.patience_s + 3.0 * period_s + kSlack_s + 0.5 * options.patience_s;
  return judge(trial, seen, most_s, most_reads, options);
}

/// The force of a hand that rests in the stone: it changes no more.
double settled_n(const FaultyDevice& device) {
  double last_n = -1.0;
  int looks = 0;
  static_cast<void>(wait_for(
      [&] {
        const double now_n = device.force_n();
        looks = std::abs(now_n - last_n) <= 0.001 * now_n ? looks + 1 : 0;
        last_n = now_n;
        return looks > 20 && device.height_m() <= kStone_m;
      },
      0.5));
  return last_n;
}

ConformanceStep try_one(const Trial& trial, Device& inner, const ConformanceOptions& options) {
  Seen seen;
  seen.info = inner.info();
  const bool cannot_be =
      trial.fault == Fault::jump || trial.fault == Fault::own_clock || trial.fault == Fault::trembles;
  if (cannot_be && !(seen.info.fastest_m_per_s > 0.0))
    return {trial.name, Result::skipped, "any position of this device is believed (fastest_m_per_s is 0)", ""};
  if ((trial.fault == Fault::early || trial.fault == Fault::dead) && !seen.info.paced)
    return {trial.name, Result::skipped, "the servo's clock is this device's pace", ""};
  FaultyDevice device(inner, options.with_force, options.patience_s);
  Seqlock<State> state;
  ServoOptions servo_options;
  servo_options.renderer.rate_hz = options.rate_hz;
  servo_options.renderer.longest_gap_s = options.patience_s;
  servo_options.renderer.stiffness_n_per_m = trial.wish_n_per_m;
  Servo servo(device, servo_options, plane(), state, {}, nullptr);
  servo.start();
  if (!touch(device)) {
    servo.stop();
    return {trial.name, Result::skipped,
            "no force came about in four attempts: this machine or this device is too late", "no force"};
  }
  if (trial.may != May::end) seen.before_n = settled_n(device);
  const std::uint64_t silences = servo.silences();
  device.inject(trial.fault);
  std::this_thread::sleep_for(
      std::chrono::duration<double>(kPause_s + (trial.pauses ? 2.0 * options.patience_s : 0.0)));
  // A wall becomes stiffer in the air alone.
  if (trial.fault == Fault::hasty && touch(device)) static_cast<void>(settled_n(device));
  // The wall of slow looks is soft, and stays so until faster ones have been seen.
  const double felt_n = trial.fault == Fault::repeats ? std::min(kFelt_n, 0.1 * firmest_n(seen, kRepeat_s)) : kFelt_n;
  if (trial.fault == Fault::repeats && touch(device, felt_n) && touch(device, felt_n)) seen.then_n = settled_n(device);
  seen.felt = device.felt();
  seen.late = !trial.pauses && servo.silences() != silences;
  seen.told = is_told(state.read());
  device.inject(Fault::none);
  seen.back = touch(device, felt_n);
  servo.stop();
  seen.held = device.force_n() != 0.0;
  return judge(trial, seen, options);
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
