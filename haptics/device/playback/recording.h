// A recorded run (run.csv) in memory: what the playback device gives and the session needs to load the same windows.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "haptics/device/device.h"

namespace sparsha::haptics {

/// From `row` on the recording was made on this window; the fields are those of HapticWindow (haptics/servo/command.h).
struct RecordedWindow {
  std::size_t row = 0;
  std::uint64_t surface_id = 0;
  int level = 0;
  int i0 = 0, j0 = 0, nx = 0, ny = 0;
  double scale = 1.0;
  bool texture = true;
  bool friction = true;
};

struct RecordedRow {
  double time_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< device frame; NaN where the device gave NaN
  std::uint64_t buttons = 0;
  ReplayTick replay;
};

/// Immutable but for how far the player may go.
class Recording {
 public:
  /// Reads the columns that it knows by name; only t_s and device_x_m, device_y_m, device_z_m are required.
  /// Throws Error{input} with file and line.
  explicit Recording(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<RecordedRow>& rows() const noexcept { return rows_; }
  /// Empty when the file has no window columns: then only the hand is played.
  [[nodiscard]] const std::vector<RecordedWindow>& windows() const noexcept { return windows_; }
  [[nodiscard]] const DeviceInfo& info() const noexcept { return info_; }
  /// Whether rows carry centre, stiffness and flags.
  [[nodiscard]] bool has_replay() const noexcept { return has_replay_; }
  /// The last row was cut in the middle, as by a power failure, and is left out.
  [[nodiscard]] bool cut_short() const noexcept { return cut_short_; }
  /// The recorded device was stronger than playback's own limits (DeviceLimits' defaults), which then apply.
  [[nodiscard]] bool limited() const noexcept { return limited_; }
  /// Of the recorded servo's plan; of older recordings the commonest step between rows.
  [[nodiscard]] double period_s() const noexcept { return period_s_; }

  /// Rows before `row` may be played; the session calls this as windows become ready. Without windows all may.
  void allow_until(std::size_t row) noexcept { allowed_.store(row, std::memory_order_release); }
  [[nodiscard]] std::size_t allowed() const noexcept { return allowed_.load(std::memory_order_acquire); }

 private:
  std::vector<RecordedRow> rows_;
  std::vector<RecordedWindow> windows_;
  DeviceInfo info_;
  bool has_replay_ = false;
  bool cut_short_ = false;
  bool limited_ = false;
  double period_s_ = 0.001;
  std::atomic<std::size_t> allowed_{0};
};

}  // namespace sparsha::haptics
