// The whole way from a configuration to a scene folder, stage by stage.
#pragma once

#include <cstdint>
#include <filesystem>

#include "pipeline/base/progress.h"
#include "pipeline/check/report.h"
#include "pipeline/scene/config.h"
#include "pipeline/scene/scene.h"

namespace sparsha::pipeline {

struct BuildOptions {
  unsigned threads = 0;            ///< 0 = one per core
  std::uint64_t memory_bytes = 0;  ///< 0 = no limit
  bool grid_only = false;          ///< read, project and write heights; nothing else
};

struct BuildResult {
  ScenePointer scene;
  Report report;
};

/// Builds in memory. Throws Error{usage, input}; Cancelled.
[[nodiscard]] BuildResult build_scene(const Config& config, const BuildOptions& options, Progress& progress);

/// Builds and writes the scene folder as a whole: beside the target, then renamed, so that an old scene survives
/// failure.
BuildResult build_scene_folder(const Config& config, const BuildOptions& options, const std::filesystem::path& folder,
                               Progress& progress);

}  // namespace sparsha::pipeline
