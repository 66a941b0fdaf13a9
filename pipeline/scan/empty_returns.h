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

/// Takes out of a scan that was read into memory what is no surface, counts it as invalid and says so in its warnings.
/// Without faces: empty returns. Of a mesh: vertices at 0 0 0, or in bulk within a hundredth of an edge about another
/// place, whose edges reach much farther than others, as of a depth camera's picture that was triangulated with its
/// holes and perhaps moved since, and the faces on them; and vertices of no face, where most have one.
void drop_what_is_no_surface(RawScan& scan);

}  // namespace sparsha::pipeline
