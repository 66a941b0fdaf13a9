// An existing scene measured against scans: its own again, or others of the same object.
#pragma once

#include <filesystem>
#include <vector>

#include "base/threads/progress.h"
#include "pipeline/report/report.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Cross-checks level 0 against `scans`, or the scene's own when empty. A scan that the scene was made from keeps its
/// units and pose, told by SHA-256; others are taken as they are. The scene's filters and `grid.noise_mm` apply where
/// all scans are its own, so that the figures are those of its build. The report's `check` is always present.
/// Throws Error{input} when scans are missing, with the reason, and for Trust::own_folder as require_own_scans().
[[nodiscard]] Report recheck_scene(const scene::Scene& scene, const std::vector<std::filesystem::path>& scans,
                                   const scene::CheckConfig& check, unsigned threads, Progress& progress,
                                   scene::Trust trust = scene::Trust::own_folder);

}  // namespace sparsha::pipeline
