#include "haptics/session/fault_watch.h"

#include <string>

namespace sparsha::haptics {
namespace {

constexpr double kPause_s = 3.0;
constexpr double kRemark_s = 30.0;  // what nothing waits for may come and go with each touch

}  // namespace

void FaultWatch::watch(const State& now, const Servo& servo, const Device& device, const SceneKeeper& keeper) {
  watch_thread(servo);
  watch_device(now, servo, device);
  // Nobody lifts a hand that was not there: an exhibit without visitors has nothing to say of it.
  constexpr double kTouch_s = 2.0;
  if (now.contact != 0) touched_s_ = now.time_s;
  if (now.time_s - touched_s_ < kTouch_s)
    tell(servo.silences(), now.time_s, silences_told_, "went_soft");
  else
    silences_told_.count = servo.silences();
  tell(servo.bad_positions(), now.time_s, bad_positions_told_, "hand_lost");
  tell(servo.jumps(), now.time_s, jumps_told_, "hand_jumped");
  tell(servo.runaways(), now.time_s, runaways_told_, "device_runs_away");
  watch_records(now, keeper);
}

void FaultWatch::watch_thread(const Servo& servo) {
  if (thread_told_ || !servo.asked_for_real_time()) return;
  thread_told_ = true;
  if (!real_time_) return;
  if (!servo.real_time()) announcer_.say("no_real_time", {}, Announcement::Priority::warning);
  if (!servo.locked_memory()) announcer_.say("no_locked_memory", {}, Announcement::Priority::warning);
}

void FaultWatch::watch_device(const State& now, const Servo& servo, const Device& device) {
  plugged_ = plugged_ || (now.tick > 0 && !servo.unplugged());
  const bool unplugged = servo.unplugged();
  if (plugged_ && unplugged && !unplugged_told_) announcer_.say("unplugged", {}, Announcement::Priority::fault);
  unplugged_told_ = unplugged;
  const DeviceAdvice* const advice = device.advice();
  if (advice == advice_told_) return;
  advice_told_ = advice;
  if (advice == nullptr) return;
  if (advice->warns) {
    if (advice == remark_ && now.time_s - remarked_s_ < kRemark_s) return;
    remark_ = advice;
    remarked_s_ = now.time_s;
  }
  announcer_.say_as_is(announcer_.phrases().text_or(advice->phrase), advice->needed || advice->warns
                                                                         ? Announcement::Priority::warning
                                                                         : Announcement::Priority::information);
}

void FaultWatch::watch_records(const State& now, const SceneKeeper& keeper) {
  if (now.dropped_records > dropped_told_) {
    dropped_told_ = now.dropped_records;
    announcer_.say("recording_loses_rows", {}, Announcement::Priority::warning);
  }
  if (scenes_lost_told_) return;
  const std::string lost = keeper.failure();
  scenes_lost_told_ = !lost.empty();
  if (scenes_lost_told_) announcer_.say("not_written", {{"reason", lost}}, Announcement::Priority::warning);
}

/// Once when it happens, and again every few seconds while it goes on.
void FaultWatch::tell(std::uint64_t count, double time_s, Told& told, Phrase words) {
  if (count == told.count || time_s - told.time_s < kPause_s) return;
  told = {count, time_s};
  announcer_.say(words, {}, Announcement::Priority::fault);
}

}  // namespace sparsha::haptics
