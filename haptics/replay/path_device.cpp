#include "haptics/replay/path_device.h"

#include <utility>

#include "haptics/state/state.h"

namespace sparsha::haptics {
namespace {

class PathDevice final : public Device {
 public:
  explicit PathDevice(std::shared_ptr<const Recording> recording) : recording_(std::move(recording)) {}

  [[nodiscard]] DeviceInfo info() const override { return played_device(*recording_); }

  [[nodiscard]] DeviceSample read(double, double) noexcept override {
    if (next_ < recording_->rows().size()) {
      share_ = recording_->rows()[next_].force_share;
      DeviceSample sample = sample_of(recording_->rows()[next_++]);
      sample.tells_applied = false;  // those are the recorded run's; of this one the servo knows what it commands
      return sample;
    }
    DeviceSample sample;
    sample.finished = true;
    return sample;
  }

  void write(const Eigen::Vector3d&) noexcept override {}
  void zero() noexcept override {}
  [[nodiscard]] double force_share() const noexcept override { return share_; }

 private:
  std::shared_ptr<const Recording> recording_;
  std::size_t next_ = 0;
  double share_ = 1.0;
};

}  // namespace

DeviceSample sample_of(const RecordedRow& row) noexcept {
  DeviceSample sample;
  sample.position_m = row.position_m;
  sample.buttons = row.buttons;
  sample.orientation = row.orientation;
  sample.time_s = row.time_s;
  sample.delay_s = row.delay_s;
  sample.force_share = row.force_share;
  sample.applied_n = row.applied_n;
  sample.tells_applied = row.applied_n.allFinite();
  sample.fresh = (row.tick.flags & kFlagStale) == 0;
  sample.homed = (row.tick.flags & kFlagHomed) != 0;
  return sample;
}

DeviceInfo played_device(const Recording& recording) {
  DeviceInfo info = recording.info();
  info.rate_hz = 1.0 / recording.period_s();
  if (recording.cut_short()) info.warning = "The recording ends in the middle of a row";
  if (recording.limited())
    info.warning += std::string(info.warning.empty() ? "" : "; ") +
                    "The recording was made with a stronger device: its forces are limited";
  return info;
}

std::unique_ptr<Device> make_path_device(std::shared_ptr<const Recording> recording) {
  return std::make_unique<PathDevice>(std::move(recording));
}

}  // namespace sparsha::haptics
