#include "haptics/servo/servo.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {

constexpr int kWatchdogPriority = 85;
constexpr std::int64_t kInTime_ns = 1'000'000;
constexpr std::int64_t kRehearsal_ns = 40'000;
constexpr int kMostLooks = 20'000;  // at the clock, should it stand still
constexpr int kFinalZeros = 3;      // packets get lost; say it more than once

}  // namespace

void ServoFigures::count(std::int64_t took_ns, std::int64_t late_ns, bool paced) noexcept {
  tick_ns.add(took_ns);
  lateness.add(late_ns);
  ++ticks;
  if (paced && late_ns <= kInTime_ns) ++ticks_in_time;
  share_in_time = static_cast<double>(ticks_in_time) / static_cast<double>(ticks + missed_ticks);
}

Servo::Servo(Device& device, const ServoOptions& options, HapticWindow window, Seqlock<State>& state,
             std::vector<std::shared_ptr<ContactQueue>> consumers, RecordSink* recorder)
    : device_(device),
      options_(options),
      period_s_(1.0 / options.renderer.rate_hz),
      period_ns_(std::llround(1e9 / options.renderer.rate_hz)),
      patience_ns_(std::llround(1e9 * options.renderer.longest_gap_s)),
      most_force_n_(usable(device.info().limits).max_force_n),
      planned_time_(device.info().planned_time),
      own_clock_(device.info().rate_hz > 0.0 && !device.info().paced),
      pace_(period_ns_),
      hand_speed_(device.info().fastest_m_per_s),
      renderer_(device.info(), options.renderer, std::move(window)),
      publisher_(state, std::move(consumers), recorder),
      watchdog_(device, std::max(options.renderer.longest_gap_s, 2.0 * period_s_)) {}

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
  figures_.faults = renderer_.faults();
  figures_.late_faults = late_faults_.load();
  figures_.runaways = runaways_.load();
  figures_.jumps = jumps_.load();
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
  if (real_time_.load(std::memory_order_relaxed)) renderer_.state().flags |= kFlagRealTime;
  asked_.store(true, std::memory_order_release);
}

void Servo::take_commands() noexcept {
  if (leaving_ && !retired_.push(std::move(leaving_))) return;  // nobody collects: keep the surface we have
  if (!commands_.pop(command_)) return;
  const std::int64_t begun_ns = options_.clock.now_ns();
  SurfacePointer old = renderer_.apply(command_);
  if (old && !retired_.push(std::move(old))) leaving_ = std::move(old);
  figures_.swap_ns_max = std::max(figures_.swap_ns_max, static_cast<double>(options_.clock.now_ns() - begun_ns));
}

void Servo::publish() noexcept {
  State& state = renderer_.state();
  state.share_in_time = figures_.share_in_time;
  state.missed_ticks = figures_.missed_ticks;
  publisher_.publish(renderer_);
  faults_.store(renderer_.faults(), std::memory_order_relaxed);
  bad_positions_.store(renderer_.bad_positions(), std::memory_order_relaxed);
}

// Since the last decision. A clock that went backwards tells as little as one that stood still.
bool Servo::is_late(std::int64_t time_ns) const noexcept {
  return has_decided_ && (time_ns < decided_ns_ || time_ns - decided_ns_ > patience_ns_ + period_ns_);
}

void Servo::stop_force() noexcept {
  device_.zero();
  device_.write(Eigen::Vector3d::Zero());
}

// The one way from the servo to the device's force.
void Servo::deliver(const std::array<double, 3>& force_n) noexcept {
  device_.write(deliverable({force_n[0], force_n[1], force_n[2]}, most_force_n_));
}

void Servo::tick(std::int64_t late_ns, double time_s, bool late_wake) noexcept {
  // One command a tick, before the hand is read: its cost never lies between position and force.
  take_commands();
  DeviceSample sample = device_.read(time_s, period_s_);
  sample.force_share = device_.force_share();
  keep_to_what_can_be(sample, time_s, own_clock_);
  const std::int64_t in_hand_ns = options_.clock.now_ns();
  if (sample.finished) finished_.store(true, std::memory_order_release);
  if (sample.finished && !sample.fresh) {  // nothing to render any more
    device_.write(Eigen::Vector3d::Zero());
    decided_ns_ = in_hand_ns;
    return;
  }
  const bool late_hand = late_wake || is_late(in_hand_ns);
  if (late_hand && !late_wake) stop_force();
  const bool jumped = hand_speed_.jumps(sample, period_s_, renderer_.look_s());
  if (jumped) jumps_.fetch_add(1, std::memory_order_relaxed);
  if (pace_.runs_away()) runaways_.fetch_add(1, std::memory_order_relaxed);
  if (late_hand || jumped || pace_.runs_away() || watchdog_.tripped()) renderer_.fault();
  renderer_.update(sample, period_s_);
  const std::int64_t decided_ns = options_.clock.now_ns();
  // The watchdog may have acted during this very tick: an old force must not overwrite its zero.
  if (is_late(decided_ns) || watchdog_.tripped()) renderer_.fail();
  State& state = renderer_.state();
  deliver(state.commanded_force_n);
  // The pause may have come between the decision and the writing: then an old force has just gone out.
  const bool late_force = is_late(options_.clock.now_ns());
  if (late_force && !late_hand) {
    stop_force();
    renderer_.fail();
  }
  if (late_force && !tripped_) late_faults_.fetch_add(1, std::memory_order_relaxed);
  decided_ns_ = decided_ns;
  has_decided_ = true;
  unplugged_.store(!sample.connected, std::memory_order_relaxed);

  state.tick_ns = static_cast<double>(decided_ns - in_hand_ns);
  state.late_ns = static_cast<double>(late_ns);
  figures_.count(decided_ns - in_hand_ns, late_ns, !pace_.runs_away());
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
  publisher_.publish_rest(renderer_);
}

// A core that wakes from sleep is slow for its first microseconds: it wakes early, computes the last tick once more,
// and polls the clock. Whether the clock went backwards meanwhile is decided by the tick.
void Servo::wait_until(std::int64_t planned_ns) noexcept {
  options_.clock.sleep_until_ns(planned_ns - kRehearsal_ns);
  const auto left_ns = [&] { return planned_ns - options_.clock.now_ns(); };
  if (left_ns() <= 0) return;
  renderer_.rehearse();
  for (int look = 0; look < kMostLooks; ++look)
    if (const std::int64_t left = left_ns(); left <= 0 || left > 2 * kRehearsal_ns) return;
}

void Servo::run_by_the_clock() noexcept {
  std::int64_t start_ns = options_.clock.now_ns() + period_ns_;
  std::int64_t planned = 0;  // ticks since the start
  while (!stopping_.load(std::memory_order_relaxed)) {
    const std::int64_t planned_ns = start_ns + planned * period_ns_;
    wait_until(planned_ns);
    const std::int64_t woke_ns = options_.clock.now_ns();
    const std::int64_t late_ns = planned_time_ ? 0 : std::max<std::int64_t>(0, woke_ns - planned_ns);
    watched_tick(planned_ns, woke_ns,
                 static_cast<double>(planned) / options_.renderer.rate_hz + 1e-9 * static_cast<double>(late_ns));
    const std::int64_t done_ns = options_.clock.now_ns();
    ++planned;
    // After a clock that went backwards the plan begins anew, or the servo would sleep until the old time comes again.
    if (done_ns < planned_ns - patience_ns_) start_ns = done_ns + period_ns_ - planned * period_ns_;
    // What is late is skipped, not caught up: a burst of ticks would be a burst of wrong velocities.
    const std::int64_t due = (done_ns - start_ns) / period_ns_;
    if (due > planned) {
      figures_.missed_ticks += static_cast<std::uint64_t>(due - planned);
      planned = due;
    }
  }
}

// The device's answers are the clock; a tick is late when the next answer is.
void Servo::run_paced() noexcept {
  const std::int64_t start_ns = options_.clock.now_ns();
  std::int64_t planned_ns = start_ns + period_ns_;
  while (!stopping_.load(std::memory_order_relaxed)) {
    device_.wait(period_s_);
    std::int64_t woke_ns = options_.clock.now_ns();
    const bool ran_away = pace_.runs_away();
    if (const std::int64_t begins_ns = pace_.admit(woke_ns); begins_ns > woke_ns) {
      if (!ran_away) stop_force();
      options_.clock.sleep_until_ns(begins_ns);
      woke_ns = options_.clock.now_ns();
    }
    watched_tick(planned_ns, woke_ns, static_cast<double>(woke_ns - start_ns) * 1e-9);
    planned_ns = woke_ns + period_ns_;
  }
}

void Servo::watched_tick(std::int64_t planned_ns, std::int64_t woke_ns, double time_s) noexcept {
  tripped_ = watchdog_.tripped();
  watchdog_.feed(now_ns());
  // Whoever stopped the whole program stopped the watchdog too, and the device has held its force all the while.
  const bool late = is_late(woke_ns);
  if (late) stop_force();
  tick(woke_ns - planned_ns, time_s, late);
  if (tripped_) watchdog_.acknowledge();  // seen by the renderer, which has disarmed
}

}  // namespace sparsha::haptics
