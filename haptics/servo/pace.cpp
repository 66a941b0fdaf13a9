#include "haptics/servo/pace.h"

#include <algorithm>
#include <cmath>

namespace sparsha::haptics {
namespace {

// A pause of the program leaves a handful of answers to be taken at once.
constexpr std::int64_t kBurstPeriods = 2;
// After so long without a fresh position the hand may be anywhere; the governor begins anew there.
constexpr double kLongAgo_s = 0.1;
// What has been the same for longer trembles no more: 33 Hz, or three looks of a device that repeats.
constexpr double kRests_s = 0.03;
constexpr double kRestLooks = 3.0;
// Of encoders and of times that are the servo's rather than the measurement's.
constexpr double kNoise_m = 0.001;
// A hand that strikes a hard stop is slowed by some 100 m/s^2, once.
constexpr double kQuickestTurn_m_per_s2 = 200.0;
constexpr double kLeastTurn_m = 0.0004;  // smaller ones are an encoder's, or noise
constexpr int kMostTurns = 4;

}  // namespace

Pace::Pace(std::int64_t period_ns) noexcept
    : least_ns_(period_ns / kMostTicksPerPeriod), burst_ns_(kBurstPeriods * period_ns) {}

// The generic cell rate algorithm (ITU-T I.371): `due_ns_` is when the next tick is due at the greatest rate.
std::int64_t Pace::admit(std::int64_t woke_ns) noexcept {
  // A clock that went backwards says nothing about the device.
  if (due_ns_ - woke_ns > 2 * burst_ns_) due_ns_ = woke_ns;
  const std::int64_t ahead_ns = due_ns_ - woke_ns;
  if (ahead_ns > burst_ns_) runs_away_ = true;
  if (ahead_ns <= 0) runs_away_ = false;
  const std::int64_t begins_ns = std::max(woke_ns, due_ns_ - burst_ns_);
  due_ns_ = std::max(due_ns_, begins_ns) + least_ns_;
  return begins_ns;
}

void keep_to_what_can_be(DeviceSample& sample, double time_s, bool own_clock) noexcept {
  if (!std::isfinite(sample.time_s) || (!own_clock && sample.time_s > time_s)) sample.time_s = time_s;
  // The longest that is believed makes the wall soft; none would make it as stiff as for a device without delay.
  sample.delay_s = sample.delay_s >= 0.0 ? std::min(sample.delay_s, kLongAgo_s) : 0.0;
  sample.force_share = sample.force_share >= 0.0 ? std::min(sample.force_share, 1.0) : 0.0;
  sample.tells_applied = sample.tells_applied && sample.applied_n.allFinite();
}

void HandSpeed::watch_turns(const Eigen::Vector3d& moved_m, double passed_s) noexcept {
  const bool turned = moved_m.dot(moved_m_) < 0.0 && std::min(moved_m.norm(), moved_m_.norm()) > kLeastTurn_m &&
                      (moved_m - moved_m_).norm() > kQuickestTurn_m_per_s2 * passed_s * passed_s;
  turns_ = turned ? std::min(turns_ + 1, 2 * kMostTurns) : std::max(turns_ - 1, 0);
  moved_m_ = moved_m;
}

bool HandSpeed::jumps(const DeviceSample& sample, double period_s, double look_s) noexcept {
  if (!(fastest_m_per_s_ > 0.0) || !sample.fresh) return false;
  if (!sample.homed || !sample.connected || !sample.position_m.allFinite()) {
    known_ = false;  // no position that the next could be compared with
    moved_m_.setZero();
    turns_ = 0;
    return false;
  }
  const double passed_s = std::max({period_s, sample.time_s - time_s_, std::min(look_s, sample.time_s - changed_s_)});
  const bool lately = known_ && passed_s < kLongAgo_s;
  const Eigen::Vector3d moved_m = lately ? Eigen::Vector3d(sample.position_m - position_m_) : Eigen::Vector3d::Zero();
  const bool jumped = moved_m.norm() > kNoise_m + fastest_m_per_s_ * passed_s;
  const bool repeated = lately && moved_m.isZero(0.0);
  if (!repeated) {
    watch_turns(moved_m, passed_s);
    changed_s_ = sample.time_s;
  } else if (sample.time_s - changed_s_ > std::max(kRests_s, kRestLooks * look_s)) {
    turns_ = 0;
  }
  known_ = true;
  time_s_ = sample.time_s;
  position_m_ = sample.position_m;
  return jumped || turns_ >= kMostTurns;
}

}  // namespace sparsha::haptics
