// Scans as the cloud that is looked at before the depth scan.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/scans.h"
#include "viewer/cloud/point_view.h"

namespace sparsha::app {

/// Beyond so many points an even sample is kept.
inline constexpr std::uint64_t kMostPointsShown = 12'000'000;

struct ReadPoints {
  std::shared_ptr<const viewer::PointView> view;
  std::vector<pipeline::Station> stations;  ///< for the search for a face
};

/// Reads all scans; triangles of meshes are covered with points. Throws Error{input}; Cancelled.
[[nodiscard]] ReadPoints read_points(const std::vector<scene::ScanConfig>& scans, const std::string& title,
                                     Progress& progress, std::uint64_t at_most = kMostPointsShown);

}  // namespace sparsha::app
