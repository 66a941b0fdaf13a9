// Plays a recording row by row, whatever the clock does: the n-th tick gets the n-th row with its recorded time.
#include <memory>

#include "haptics/device/devices.h"
#include "haptics/device/playback/recording.h"
#include "haptics/shared/state.h"

namespace sparsha::haptics {
namespace {

class PlaybackDevice final : public Device {
 public:
  explicit PlaybackDevice(const std::filesystem::path& file) : recording_(file) {}

  [[nodiscard]] DeviceInfo info() const override { return recording_.info(); }
  [[nodiscard]] Recording* recording() noexcept override { return &recording_; }

  [[nodiscard]] DeviceSample read(double, double) noexcept override {
    DeviceSample sample;
    if (next_ >= recording_.rows().size()) {
      sample.finished = true;
      sample.paused = true;
      return sample;
    }
    if (next_ >= recording_.allowed()) {
      sample.paused = true;
      return sample;
    }
    const RecordedRow& row = recording_.rows()[next_++];
    sample.position_m = row.position_m;
    sample.buttons = row.buttons;
    sample.time_s = row.time_s;
    sample.fresh = (row.replay.flags & kFlagStale) == 0;
    sample.homed = (row.replay.flags & kFlagHomed) != 0;
    if (recording_.has_replay()) sample.replay = &row.replay;
    return sample;
  }

  void write(const Eigen::Vector3d&) noexcept override {}
  void zero() noexcept override {}

 private:
  Recording recording_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<Device> make_playback_device(const std::filesystem::path& recording) {
  return std::make_unique<PlaybackDevice>(recording);
}

}  // namespace sparsha::haptics
