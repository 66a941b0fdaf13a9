// What a scan's numbers mean in metres, and whether that can be true.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "pipeline/scan/origin.h"
#include "pipeline/scan/reader.h"
#include "scene/length_unit.h"

namespace sparsha::pipeline {

/// A unit that fits better than metres, and why; nothing when metres are plausible. `low` and `high` bound the scan
/// without its outliers, in file units.
struct UnitGuess {
  LengthUnit unit = LengthUnit::m;
  std::string reason;
};
[[nodiscard]] std::optional<UnitGuess> doubt_metres(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// The same from a sample of its points.
[[nodiscard]] std::optional<UnitGuess> doubt_metres(const PointSample& sample);

/// The same for a scan in memory whose format names no unit; nothing when it does. For `sparsha new`.
[[nodiscard]] std::optional<UnitGuess> guess_unit(const RawScan& scan);

/// Throws Error{input} for a scan in degrees, whose numbers no unit makes lengths.
void require_lengths(const RawScan& scan, const std::string& file);

}  // namespace sparsha::pipeline
