#include "haptics/conformance/faulty_device.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "haptics/servo/real_time.h"

namespace sparsha::haptics {
namespace {

constexpr double kAir_m = 0.01;
constexpr double kSpeed_m_per_s = 0.1;
constexpr double kJump_m = 0.03;  // aside, at the same depth
constexpr double kLongPause_s = 0.3;
constexpr double kTooFast = 8.0;  // seconds that a clock of its own gains in one
constexpr double kTremble_m = 0.0005;

}  // namespace

FaultyDevice::FaultyDevice(Device& inner, bool with_force, double patience_s)
    : inner_(inner),
      with_force_(with_force),
      paced_(inner.info().paced),
      patience_s_(patience_s),
      wish_m_(kAir_m),
      height_m_(kAir_m) {}

DeviceInfo FaultyDevice::info() const {
  DeviceInfo info = inner_.info();
  info.planned_time = false;  // the hand here is one of real time
  return info;
}

void FaultyDevice::inject(Fault fault) noexcept {
  injections_.fetch_add(1);
  injected_ns_.store(now_ns());
  reads_.store(0);
  reads_with_force_.store(0);
  last_force_ns_.store(0);
  first_zero_ns_.store(-1);
  strongest_n_.store(0.0);
  finite_.store(true);
  counted_.store(false);
  paused_.store(false);
  fault_.store(fault);
  injections_.fetch_add(1);
}

void FaultyDevice::pause_once() noexcept {
  const Fault fault = fault_.load();
  if ((fault != Fault::late && fault != Fault::hangs && fault != Fault::stuck) || paused_.exchange(true)) return;
  const double pause_s = fault == Fault::late ? 1.5 * patience_s_ : patience_s_ + kLongPause_s;
  sleep_until_ns(now_ns() + static_cast<std::int64_t>(pause_s * 1e9));
}

void FaultyDevice::wait(double timeout_s) noexcept {
  const Fault fault = fault_.load();
  if (fault == Fault::early || fault == Fault::dead) return;
  if (fault != Fault::stuck) pause_once();
  inner_.wait(timeout_s);
}

DeviceSample FaultyDevice::read(double time_s, double period_s) noexcept {
  read_of_ = injections_.load();
  const Fault fault = fault_.load();
  static_cast<void>(inner_.read(time_s, period_s));
  if (!paced_ && fault != Fault::stuck) pause_once();
  const std::uint64_t before = reads_.fetch_add(1);
  const double most_m = kSpeed_m_per_s * std::clamp(time_s - time_s_, 0.0, 0.01);
  ahead_s_ = fault == Fault::own_clock ? ahead_s_ + kTooFast * std::max(0.0, time_s - time_s_) : 0.0;
  const double passed_s = time_s - time_s_;
  time_s_ = time_s;
  height_m_.store(height_m_ + std::clamp(wish_m_ - height_m_, -most_m, most_m));
  DeviceSample sample;
  const bool aside = fault == Fault::jump || fault == Fault::own_clock;
  sample.position_m = {aside ? kJump_m : 0.0, 0.0, height_m_};
  if (fault == Fault::trembles) sample.position_m.z() += before % 2 == 0 ? kTremble_m : -kTremble_m;
  account(sample.position_m.z(), passed_s);
  if (fault != Fault::repeats || time_s >= looked_s_ + kRepeat_s) {
    looked_s_ = time_s;
    told_m_ = sample.position_m.z();
  }
  sample.position_m.z() = told_m_;
  sample.time_s = time_s + ahead_s_;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (fault == Fault::no_time) sample.time_s = kNone;
  if (fault == Fault::lies) {
    sample.delay_s = before % 2 == 0 ? std::numeric_limits<double>::infinity() : kNone;
    sample.applied_n.setConstant(kNone);
    sample.tells_applied = true;
    sample.orientation.fill(kNone);
  }
  if (fault == Fault::hasty) sample.delay_s = before % 2 == 0 ? 1e-9 : -1.0;
  sample.finished = fault == Fault::ended;
  sample.fresh = fault != Fault::silent && fault != Fault::dead && fault != Fault::ended;
  sample.connected = fault != Fault::unplugged && !(fault == Fault::loose && before % 2 == 0);
  sample.homed = fault != Fault::stopped;
  if (fault == Fault::not_a_number) sample.position_m.y() = std::numeric_limits<double>::quiet_NaN();
  if (fault == Fault::infinite) sample.position_m.z() = -std::numeric_limits<double>::infinity();
  return sample;
}

void FaultyDevice::note(double force_n) noexcept {
  if (!std::isfinite(force_n)) finite_.store(false);
  const std::int64_t since_ns = now_ns() - injected_ns_.load();
  const bool held = force_n_.load() != 0.0;
  if (held) last_force_ns_.store(since_ns);
  if (force_n == 0.0 && first_zero_ns_.load() < 0) first_zero_ns_.store(since_ns);
  force_n_.store(force_n);
  strongest_n_.store(std::max(strongest_n_.load(), force_n));
}

/// The force of before has been held all the way to here.
void FaultyDevice::account(double z_m, double passed_s) noexcept {
  if (!counted_.exchange(true)) {
    work_j_ = least_j_ = shaken_sum_n_ = squares_ = 0.0;
    z_m_ = z_m;
    last_n_ = -1.0;
    delivered_j_.store(0.0);
    square_m2_per_s_.store(0.0);
    shaken_n_.store(0.0);
  }
  if (held_z_n_.load() != 0.0 && passed_s > 0.0) squares_ += (z_m - z_m_) * (z_m - z_m_) / passed_s;
  square_m2_per_s_.store(squares_);
  work_j_ += held_z_n_.load() * (z_m - std::exchange(z_m_, z_m));
  least_j_ = std::min(least_j_, work_j_);
  delivered_j_.store(std::max(delivered_j_.load(), work_j_ - least_j_));
}

void FaultyDevice::compare(double force_n) noexcept {
  const std::uint64_t reads = reads_.load();
  if (reads == 0 || !counted_.load()) return;
  const bool first = last_n_ < 0.0;
  weakest_n_.store(first ? force_n : std::min(weakest_n_.load(), force_n));
  if (!first) shaken_sum_n_ += std::abs(force_n - last_n_);
  shaken_n_.store(shaken_sum_n_ / static_cast<double>(reads));
  last_n_ = force_n;
}

void FaultyDevice::write(const Eigen::Vector3d& force_n) noexcept {
  const double size_n = force_n.norm();
  note(size_n);  // what has been taken is held while the call lasts
  compare(size_n);
  held_z_n_.store(force_n.z());
  if (fault_.load() == Fault::stuck) pause_once();
  // The tick that was under way when the fault came had not seen it.
  const bool saw_the_fault = read_of_ % 2 == 0 && read_of_ == injections_.load();
  if (size_n != 0.0 && saw_the_fault && reads_.load() > 0) reads_with_force_.fetch_add(1);
  inner_.write(with_force_ ? force_n : Eigen::Vector3d::Zero());
}

double FaultyDevice::force_share() const noexcept {
  return fault_.load() == Fault::lies ? std::numeric_limits<double>::quiet_NaN() : inner_.force_share();
}

void FaultyDevice::zero() noexcept {
  note(0.0);
  held_z_n_.store(0.0);
  inner_.zero();
}

Felt FaultyDevice::felt() const noexcept {
  Felt felt;
  felt.strongest_n = strongest_n_.load();
  felt.weakest_n = weakest_n_.load();
  felt.shaken_n = shaken_n_.load();
  felt.delivered_j = delivered_j_.load();
  felt.square_m2_per_s = square_m2_per_s_.load();
  felt.finite = finite_.load();
  felt.reads_with_force = reads_with_force_.load();
  felt.last_force_s = 1e-9 * static_cast<double>(last_force_ns_.load());
  felt.first_zero_s = first_zero_ns_.load() < 0 ? -1.0 : 1e-9 * static_cast<double>(first_zero_ns_.load());
  return felt;
}

}  // namespace sparsha::haptics
