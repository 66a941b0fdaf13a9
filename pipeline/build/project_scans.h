// From scans to heights: in memory, or through files on disk where a memory limit asks for it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/system/disk_arrays.h"
#include "base/threads/context.h"
#include "pipeline/build/build.h"
#include "pipeline/charts/charts.h"
#include "pipeline/check/charts_check.h"
#include "pipeline/check/check.h"
#include "pipeline/projection/projection.h"
#include "pipeline/report/report.h"
#include "scene/config/config.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

struct ProjectedScans {
  Projection projection;
  std::vector<scene::ScanSource> sources;
  Eigen::Matrix4d scan_to_grid = Eigen::Matrix4d::Identity();  ///< the configuration's, or what `face` has found
  std::string orientation;                                     ///< what `face` has found, in words; else empty
  std::optional<scene::UnrollConfig> unroll;       ///< with what was found; then the grid's frame is the unrolled one
  std::optional<double> nearest_of_chosen_unit_m;  ///< see ScanSet
  Report::Points points;
  std::uint64_t triangles = 0;  ///< of meshes among the scans, after the filters
  std::vector<Report::Filter> filters;
  std::vector<Eigen::Vector3d> kept_m;    ///< a sample of the points that filters left, scan frame
  std::vector<Eigen::Vector3d> sample_m;  ///< the same, when the configuration looks for pillars
  /// Checks the finished grid (which it may hold meanwhile) against the points; null when nothing asks for it.
  std::function<CheckResult(scene::DepthGrid& grid)> check;
  std::optional<ChartResult> charts;  ///< when the configuration has a block `around`
  /// Checks charts against all points that filters left; before `check`, and null when that is.
  std::function<ChartCheck(const scene::Charts& charts)> check_charts;
  /// Where large arrays lie from here on when the nodes do not fit the memory limit; else null.
  std::shared_ptr<system::DiskArrays> disk_arrays;
};

/// Reads, filters and projects. The same result whether out of core or not. Throws Error{usage, input}; Error{failure}
/// when a limit cannot be kept, naming the filter or the grid that is in the way, or the disk is full; Cancelled. The
/// arguments must outlive `check`.
[[nodiscard]] ProjectedScans project_scans(const scene::Config& config, const BuildOptions& options,
                                           const Context& context);

/// A report of what became of the points; takes the filters' findings.
[[nodiscard]] Report take_counts(ProjectedScans& scans);

}  // namespace sparsha::pipeline
