// Scans as the cloud that is looked at before the depth scan.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/raw_scans/refinement.h"
#include "base/threads/progress.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/scans.h"
#include "viewer/cloud/point_view.h"

namespace sparsha::app {

/// Beyond so many points an even sample is kept.
inline constexpr std::uint64_t kMostPointsShown = 12'000'000;

/// What a point that is shown takes, with its colours and while it is sorted; about.
inline constexpr std::uint64_t kBytesPerPointShown = 64;
/// Of a COPC file, whole coarse levels come first: so many that they have this many points.
inline constexpr std::uint64_t kCoarsePoints = 250'000;

struct ReadPoints {
  std::shared_ptr<const viewer::PointView> view;
  std::vector<CoarseScan> coarse;           ///< scans of which finer levels can be read, see Refinement
  std::vector<pipeline::Station> stations;  ///< for the search for a face
};

/// Reads all scans, of COPC files the coarse levels; triangles of meshes are covered with points. Throws Error{input};
/// Cancelled.
[[nodiscard]] ReadPoints read_points(const std::vector<scene::ScanConfig>& scans, const std::string& title,
                                     Progress& progress, std::uint64_t at_most = kMostPointsShown,
                                     std::uint64_t coarse = kCoarsePoints);

}  // namespace sparsha::app
