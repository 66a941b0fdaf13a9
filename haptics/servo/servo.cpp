#include "haptics/servo/servo.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {

constexpr int kServoPriority = 80;
constexpr int kWatchdogPriority = 85;
constexpr std::int64_t kInTimeNs = 1'000'000;
constexpr int kFinalZeros = 3;  // packets get lost; say it more than once

}  // namespace

Servo::Servo(Device& device, const ServoOptions& options, HapticWindow window, Seqlock<State>& state,
             std::vector<std::shared_ptr<ContactQueue>> consumers, Recorder* recorder)
    : device_(device),
      options_(options),
      period_s_(1.0 / options.engine.rate_hz),
      period_ns_(std::llround(1e9 / options.engine.rate_hz)),
      engine_(device.info(), options.engine, std::move(window)),
      state_(state),
      consumers_(std::move(consumers)),
      recorder_(recorder),
      watchdog_(device, options.silence_s) {}

Servo::~Servo() { stop(); }

void Servo::start() {
  stopping_.store(false);
  watchdog_.start(options_.real_time ? kWatchdogPriority : 0);
  thread_ = std::thread([this] { run(); });
}

void Servo::stop() {
  stopping_.store(true);
  if (!thread_.joinable()) return;
  thread_.join();
  watchdog_.stop();
  figures_.watchdog_trips = watchdog_.trips();
  figures_.faults = engine_.faults();
  figures_.real_time = real_time_;
  figures_.locked_memory = locked_;
  collect();
}

void Servo::collect() noexcept {
  SurfacePointer surface;
  while (retired_.pop(surface)) surface.reset();
}

void Servo::prepare_thread() noexcept {
  if (options_.real_time) {
    real_time_.store(request_real_time(kServoPriority), std::memory_order_relaxed);
    locked_.store(lock_memory(), std::memory_order_relaxed);
  }
  touch_stack();
  if (real_time_.load(std::memory_order_relaxed)) engine_.state().flags |= kFlagRealTime;
  asked_.store(true, std::memory_order_release);
}

void Servo::take_commands() noexcept {
  if (leaving_ && !retired_.push(std::move(leaving_))) return;  // nobody collects: keep the surface we have
  if (!has_pending_) {
    if (!commands_.pop(pending_)) return;
    has_pending_ = true;
  }
  if (pending_.at_tick > engine_.state().tick + 1) return;
  const std::int64_t begun_ns = now_ns();
  SurfacePointer old = engine_.obey(pending_);
  has_pending_ = false;
  if (old && !retired_.push(std::move(old))) leaving_ = std::move(old);
  figures_.swap_ns_max = std::max(figures_.swap_ns_max, static_cast<double>(now_ns() - begun_ns));
}

void Servo::publish() noexcept {
  State& state = engine_.state();
  state.share_in_time = figures_.share_in_time;
  state.missed_ticks = figures_.missed_ticks;
  state.dropped_records = recorder_ != nullptr ? recorder_->dropped() : 0;
  state_.publish(state);
  if (recorder_ != nullptr) static_cast<void>(recorder_->push(engine_.record()));
  if (engine_.event())
    for (const auto& consumer : consumers_) static_cast<void>(consumer->push(*engine_.event()));
  faults_.store(engine_.faults(), std::memory_order_relaxed);
  bad_positions_.store(engine_.bad_positions(), std::memory_order_relaxed);
}

void Servo::tick(std::int64_t late_ns, double time_s) noexcept {
  // One command a tick, before the hand is read: its cost never lies between position and force.
  take_commands();
  const DeviceSample sample = device_.read(time_s, period_s_);
  if (sample.finished) finished_.store(true, std::memory_order_release);
  if (sample.paused) {
    device_.write(Eigen::Vector3d::Zero());
    return;
  }
  const std::int64_t in_hand_ns = now_ns();
  // A replay repeats the recorded faults, not those of this run; nobody holds its motors.
  const bool watched = sample.replay == nullptr;
  if (watched && watchdog_.tripped()) engine_.fault();
  engine_.update(sample, period_s_);
  const std::int64_t decided_ns = now_ns();
  State& state = engine_.state();
  // It may have bitten during this very tick: an old force must not overwrite its zero.
  if (watched && watchdog_.tripped()) state.commanded_force_n = {};
  device_.write({state.commanded_force_n[0], state.commanded_force_n[1], state.commanded_force_n[2]});
  unplugged_.store(!sample.connected, std::memory_order_relaxed);

  state.tick_ns = static_cast<double>(decided_ns - in_hand_ns);
  state.late_ns = static_cast<double>(late_ns);
  figures_.tick_ns.add(decided_ns - in_hand_ns);
  figures_.lateness.add(late_ns);
  ++figures_.ticks;
  if (late_ns <= kInTimeNs) ++in_time_;
  figures_.share_in_time = static_cast<double>(in_time_) / static_cast<double>(figures_.ticks + figures_.missed_ticks);
  publish();
}

void Servo::run() noexcept {
  prepare_thread();
  if (device_.info().paced)
    run_paced();
  else
    run_by_the_clock();
  for (int i = 0; i < kFinalZeros; ++i) device_.write(Eigen::Vector3d::Zero());
  device_.zero();
  State& state = engine_.state();
  state.commanded_force_n = {};
  state_.publish(state);
}

void Servo::run_by_the_clock() noexcept {
  const std::int64_t start_ns = now_ns() + period_ns_;
  std::int64_t planned = 0;  // ticks since the start
  while (!stopping_.load(std::memory_order_relaxed)) {
    const std::int64_t planned_ns = start_ns + planned * period_ns_;
    sleep_until_ns(planned_ns);
    watched_tick(planned_ns, static_cast<double>(planned) / options_.engine.rate_hz);
    // What is late is skipped, not caught up: a burst of ticks would be a burst of wrong velocities.
    const std::int64_t due = (now_ns() - start_ns) / period_ns_;
    if (due > ++planned) {
      figures_.missed_ticks += static_cast<std::uint64_t>(due - planned);
      planned = due;
    }
  }
}

// The device's answers are the clock; a tick is late when the next answer is.
void Servo::run_paced() noexcept {
  const std::int64_t start_ns = now_ns();
  std::int64_t planned_ns = start_ns + period_ns_;
  while (!stopping_.load(std::memory_order_relaxed)) {
    device_.wait(period_s_);
    const std::int64_t woke_ns = now_ns();
    watched_tick(planned_ns, static_cast<double>(woke_ns - start_ns) * 1e-9);
    planned_ns = woke_ns + period_ns_;
  }
}

void Servo::watched_tick(std::int64_t planned_ns, double time_s) noexcept {
  const std::int64_t woke_ns = now_ns();
  const bool bitten = watchdog_.tripped();
  watchdog_.feed(woke_ns);
  tick(woke_ns - planned_ns, time_s);
  if (bitten) watchdog_.acknowledge();  // seen by the engine, which has disarmed
}

}  // namespace sparsha::haptics
