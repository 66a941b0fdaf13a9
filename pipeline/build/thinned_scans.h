// Scans that go through a voxel filter as they are read: only the voxels must fit into memory.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/filter/filter.h"
#include "pipeline/report/report.h"
#include "pipeline/scan/cloud.h"
#include "pipeline/scan/set.h"
#include "scene/config/filters.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

struct ThinnedScans {
  std::shared_ptr<Cloud> cloud;
  Report::Points points;
  FilterSteps steps;                      ///< up to the voxel filter, which is the last of them
  std::vector<scene::FilterConfig> rest;  ///< the filters after it
};

/// The first of `filters` that cannot be streamed must be `voxel`. Throws Error{failure} that names it when it leaves
/// more than `most` voxels; Error{input} when no point is left; Cancelled.
[[nodiscard]] ThinnedScans thin_scans(const ScanSet& scans, const scene::Config& config,
                                      const std::vector<scene::FilterConfig>& filters, std::uint64_t most,
                                      const Context& context);

}  // namespace sparsha::pipeline
