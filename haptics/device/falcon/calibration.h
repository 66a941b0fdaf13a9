// Motor counts per newton metre of one Falcon, found with a known weight on its grip, and where that is kept.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "haptics/device/device.h"

namespace sparsha::haptics::falcon {

/// What a Falcon is taken to have when it was never calibrated.
inline constexpr double kUsualCounts = 10000.0;
/// Beyond these no weight was measured.
inline constexpr double kLeastCounts = 1000.0, kMostCounts = 60000.0;

/// ~/.config/sparsha/falcon.yaml, or where XDG_CONFIG_HOME puts it.
[[nodiscard]] std::filesystem::path calibration_file();
/// `counts_per_newton_metre` of that file; empty when there is none. Throws Error{usage} with line and column.
[[nodiscard]] std::optional<double> stored_calibration(const std::filesystem::path& file = calibration_file());
/// Throws as store_calibration() would, before a person has held a weight for a minute. Creates the file's folder.
void require_calibration_place(const std::filesystem::path& file = calibration_file());
/// Writes it, whole or not at all. Throws Error.
void store_calibration(double counts_per_newton_metre, const std::filesystem::path& file = calibration_file());

struct Calibration {
  double counts_per_newton_metre = 0.0;
  double weight_n = 0.0;
  double empty_n = 0.0;    ///< upward force that held the bare grip, at the device's present scale
  double loaded_n = 0.0;   ///< with the weight
  double scatter_n = 0.0;  ///< standard error of their difference
};

struct CalibrationOptions {
  double weight_n = 1.961;                        ///< 200 g
  double counts_per_newton_metre = kUsualCounts;  ///< that `device` works with
  double patience_s = 60.0;                       ///< for each step that a person takes
  std::function<double()> clock_s;                ///< the time; empty = the steady clock
};

/// Holds the grip in the middle by a soft spring, first bare, then with the weight; the difference of the forces is
/// the weight's. `say` is told what the person has to do, each thing once; `stop` ends it (empty result). Drives the
/// device as the servo would: call it on a thread of real-time priority. Throws Error{device} when a step takes too
/// long, the device goes, or the result is impossible.
[[nodiscard]] std::optional<Calibration> calibrate(Device& device, const CalibrationOptions& options,
                                                   const std::function<void(const std::string&)>& say,
                                                   const std::function<bool()>& stop = {});

}  // namespace sparsha::haptics::falcon
