// Parts of a scan that lie apart in space: islands beside an object hide it, or stretch the grid.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

struct Pieces {
  std::size_t count = 0;
  double apart = 0.0;          ///< the largest one is at least so far from all others, file units
  double largest_share = 0.0;  ///< of the points
};

/// Of a mesh, whose points are in memory: what its triangles do not join and more than a 64th of its length keeps
/// apart. Nothing when all is in one piece.
[[nodiscard]] std::optional<Pieces> pieces_of_mesh(const RawScan& scan);

/// Of points by a sample of them: groups of a hundredth of the points or more, apart by a 16th of the scan's length and
/// by several distances of the sample's points.
[[nodiscard]] std::optional<Pieces> pieces_of_points(const std::vector<Eigen::Vector3d>& sample);

/// Whether point scans of one object that are in pieces each may be so for another reason than that a station does not
/// see what lies between: there is but one, or `sample` of all of them is in pieces, too.
[[nodiscard]] bool apart_together(std::size_t scans, const std::vector<Eigen::Vector3d>& sample);

}  // namespace sparsha::pipeline
