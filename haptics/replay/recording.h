// A recorded run (run.csv) in memory: the path of the hand, and the windows that it was made on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// From `row` on the recording was made on this window.
struct RecordedWindow {
  std::size_t row = 0;
  std::uint64_t surface_id = 0;
  std::uint64_t scene = 1;  ///< number of the scene whose nodes `plan` names; 1 where the file does not say
  WindowPlan plan;
};

/// Makes the surface of a recorded window. Throws Error{input} when tiles cannot be read.
[[nodiscard]] HapticWindow load_recorded(const scene::Scene& scene, const RecordedWindow& recorded);

struct RecordedRow {
  double time_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< device frame; NaN where the device gave NaN
  std::uint64_t buttons = 0;
  std::array<double, 4> orientation{};                  ///< as in State
  double delay_s = 0.0;                                 ///< as in DeviceSample; 0 in recordings that do not say it
  double force_share = 1.0;                             ///< as in DeviceSample
  Eigen::Vector3d applied_n = Eigen::Vector3d::Zero();  ///< as in Record; not numbers where the file does not say it
  RecordedTick tick;
};

/// Immutable.
class Recording {
 public:
  /// Reads the columns that it knows by name; only t_s and device_x_m, device_y_m, device_z_m are required.
  /// Throws Error{input} with file and line.
  explicit Recording(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  [[nodiscard]] const std::vector<RecordedRow>& rows() const noexcept { return rows_; }
  /// Empty when the file has no window columns: then only the hand is played.
  [[nodiscard]] const std::vector<RecordedWindow>& windows() const noexcept { return windows_; }
  [[nodiscard]] const DeviceInfo& info() const noexcept { return info_; }
  /// The last row was cut in the middle, as by a power failure, and is left out.
  [[nodiscard]] bool cut_short() const noexcept { return cut_short_; }
  /// The recorded device was stronger than the limits of replays (DeviceLimits' defaults), which then apply.
  [[nodiscard]] bool limited() const noexcept { return limited_; }
  /// Of the recorded servo's plan; of older recordings the commonest step between rows.
  [[nodiscard]] double period_s() const noexcept { return period_s_; }

 private:
  std::filesystem::path file_;
  std::vector<RecordedRow> rows_;
  std::vector<RecordedWindow> windows_;
  DeviceInfo info_;
  bool cut_short_ = false;
  bool limited_ = false;
  double period_s_ = 0.001;
};

}  // namespace sparsha::haptics
