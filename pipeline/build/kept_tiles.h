// The tiles that a build keeps, if it is to, and whether those of an earlier one are its own.
#pragma once

#include <optional>
#include <vector>

#include "base/threads/progress.h"
#include "pipeline/build/build.h"
#include "pipeline/outofcore/finished_tiles.h"
#include "pipeline/projection/plan.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

/// Opens options.finished_tiles; nothing when it is empty. Begins a stage that names how many tiles are there, and
/// warns of those that were made of other scans, by another configuration or by another program, which are left out.
/// Throws Error{failure}, Cancelled.
[[nodiscard]] std::optional<FinishedTiles> open_kept_tiles(const BuildOptions& options, const scene::Config& config,
                                                           const std::vector<scene::ScanSource>& sources,
                                                           const ProjectionPlan& plan, Progress& progress);

}  // namespace sparsha::pipeline
