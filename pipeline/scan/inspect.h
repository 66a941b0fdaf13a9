// What `sparsha info` says of a scan, and what other rooms tell of its points while these are in memory.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// Gets the valid points of a scan without triangles; `points` times `unit_m` are metres, or the file's own units where
/// these are unknown.
using LookAtPoints = std::function<void(const std::vector<Eigen::Vector3d>& points, double unit_m)>;

/// As inspect_scan() without `look`, which is not called for a mesh, for degrees, nor where there are no points.
[[nodiscard]] ScanInfo inspect_scan(const std::filesystem::path& file, const Progress* progress,
                                    const LookAtPoints& look);

}  // namespace sparsha::pipeline
