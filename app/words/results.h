// Results as text a person reads.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/report/report.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// The few lines `sparsha build` ends with: size, grid, points, coverage, cross-check, time, place.
[[nodiscard]] std::string build_summary(const scene::Scene& scene, const pipeline::Report& report,
                                        const std::filesystem::path& folder);

}  // namespace sparsha::app
