// Points that a depth camera or scanner writes where it got no answer: 0 0 0 in its own coordinates, by the thousand.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// Whether a point stands at 0 0 0 of its file, or where its scanner stood (0 0 0 before the file's own pose).
[[nodiscard]] inline bool is_at_scanner(const Eigen::Vector3d& point, const std::optional<Eigen::Vector3d>& station) {
  return (point.array() == 0.0).all() || (station && point == *station);
}

/// Whether `at_scanner` of a scan's finite points are no surface: a surface through 0 0 0 has one point there.
[[nodiscard]] bool are_empty_returns(std::uint64_t at_scanner, std::uint64_t points);

/// What is said of them when they are counted as invalid.
[[nodiscard]] std::string empty_returns_warning(std::uint64_t at_scanner, std::uint64_t points);

/// Takes them out of a scan that was read into memory, counts them as invalid and says so in its warnings. Scans with
/// faces stay as they are: their vertices are meant.
void drop_empty_returns(RawScan& scan);

}  // namespace sparsha::pipeline
