// Tells the visitor of what goes wrong while the servo runs.
#pragma once

#include <cstdint>

#include "haptics/device/device.h"
#include "haptics/replay/scene_keeper.h"
#include "haptics/servo/servo.h"
#include "haptics/session/announcer.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// Session's thread only.
class FaultWatch {
 public:
  /// `real_time`: the servo asks for it, and is expected to get it.
  FaultWatch(Announcer& announcer, bool real_time) : announcer_(announcer), real_time_(real_time) {}

  /// Announces what is new since the last call; faults that go on again every few seconds.
  void watch(const State& now, const Servo& servo, const Device& device, const SceneKeeper& keeper);

 private:
  struct Told {
    std::uint64_t count = 0;
    double time_s = -1e9;
  };
  void watch_thread(const Servo& servo);
  void watch_device(const State& now, const Servo& servo, const Device& device);
  void watch_records(const State& now, const SceneKeeper& keeper);
  void tell(std::uint64_t count, double time_s, Told& told, Phrase words);

  Announcer& announcer_;
  bool real_time_;
  bool thread_told_ = false;
  bool plugged_ = false;  ///< at any time: who begins without a device hears the device's own advice
  bool unplugged_told_ = false;
  const DeviceAdvice* advice_told_ = nullptr;
  const DeviceAdvice* remark_ = nullptr;  // the last that warns without a need
  double remarked_s_ = -1e9;
  double touched_s_ = -1e9;  // when the stone was touched last
  Told silences_told_;
  Told bad_positions_told_;
  Told jumps_told_;
  Told runaways_told_;
  std::uint64_t dropped_told_ = 0;
  bool scenes_lost_told_ = false;
};

}  // namespace sparsha::haptics
