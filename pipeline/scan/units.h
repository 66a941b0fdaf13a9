// What a scan's numbers mean in metres, and whether that can be true.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/origin.h"
#include "pipeline/scan/reader.h"
#include "scene/frame/length_unit.h"

namespace sparsha::pipeline {

/// Whether metres at that distance from zero can be those of an object so long, in a frame of its own. A georeferenced
/// site lies at thousands of its own lengths, and nothing on Earth at 1e8.
[[nodiscard]] bool may_be_local(double side, double away);

/// A unit that fits better than metres, and why; nothing when metres are plausible. `low` and `high` bound the scan
/// without its outliers, in file units.
struct UnitGuess {
  scene::LengthUnit unit = scene::LengthUnit::m;
  std::string reason;
  bool may_be_metres = false;  ///< of a national grid whose zero is near
};
[[nodiscard]] std::optional<UnitGuess> doubt_metres(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// The same from a sample of its points.
[[nodiscard]] std::optional<UnitGuess> doubt_metres(const PointSample& sample);

/// The same for a scan in memory whose format names no unit; nothing when it does. For `sparsha new`.
[[nodiscard]] std::optional<UnitGuess> guess_unit(const RawScan& scan);

/// What tells the unit of one of several scans of an object: lengths as they are read, metres where no unit is known.
struct ScanSize {
  std::string name;
  Eigen::Vector3d low = Eigen::Vector3d::Zero();  ///< box without outliers
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  double apart = 0.0;     ///< distance of its points, by the box; 0 when there are none
  bool has_unit = false;  ///< by its format or by the configuration

  ScanSize() = default;
  /// `sample` of `points` points.
  ScanSize(std::string file, const std::vector<Eigen::Vector3d>& sample, std::uint64_t points, bool unit);
};

/// Two scans that cannot be in one unit: one is about 10, 100 or 1000 times as large as the other and its points are as
/// many times as far apart; for 10 and 100 more exactly so, and they must lie side by side in their own units, since a
/// detail may be scanned ten times as finely.
struct UnitDifference {
  std::size_t large = 0, small = 0;                   ///< indices of the scans
  scene::LengthUnit of_large = scene::LengthUnit::m;  ///< units that explain it
  scene::LengthUnit of_small = scene::LengthUnit::m;
  std::string reason;  ///< one sentence
};
[[nodiscard]] std::vector<UnitDifference> differing_units(const std::vector<ScanSize>& scans);

/// Throws Error{input} for a scan in degrees, whose numbers no unit makes lengths; told or guessed.
void require_lengths(const RawScan& scan, const std::string& file);

}  // namespace sparsha::pipeline
