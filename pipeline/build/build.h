// The whole way from a configuration to a scene folder, stage by stage.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "base/system/disk_arrays.h"
#include "base/threads/progress.h"
#include "pipeline/cluster/ranks.h"
#include "pipeline/report/report.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

struct BuildOptions {
  unsigned threads = 0;    ///< 0 = one per core
  bool grid_only = false;  ///< read, project and write heights; nothing else
  bool force = false;      ///< also a scene whose surface lies more than a spacing from half of the points
  /// Limit of memory; 0 = none. What does not fit is built through files on disk, with the same result.
  std::uint64_t memory_bytes = 0;
  /// At most so many points in memory at once, whatever they need; 0 = as many as memory_bytes allows.
  std::uint64_t memory_points = 0;
  /// Where such files are, without a name: they go with the build. build_scene_folder takes the scene's parent folder
  /// when it is empty, build_scene the system's folder for temporary files.
  std::filesystem::path scratch_folder;
  /// Where tiles of the grid are kept as they are measured, through files on disk whatever the limit; a build that
  /// finds its own there goes on from them. Empty: nowhere. build_scene_folder() removes it once the scene is written.
  std::filesystem::path finished_tiles;
  /// What builds the scene, as a hash: tiles of another program are not gone on from, and ranks have the same.
  std::string program;
  /// Of those that build this scene together, with the same configuration and options; null alone. The root alone
  /// writes the scene, the others call take_part_in_build().
  const Ranks* ranks = nullptr;
};

struct BuildResult {
  std::shared_ptr<system::DiskArrays> disk_arrays;  ///< in which the scene lies; null when it is in memory
  scene::ScenePointer scene;
  Report report;
};

/// Builds a scene held in memory. Throws Error{usage, input}, Error{failure} when a limit cannot be kept;
/// Cancelled.
[[nodiscard]] BuildResult build_scene(const scene::Config& config, const BuildOptions& options, Progress& progress);

/// Builds and writes the scene folder as a whole: beside the target, then renamed, so that an old scene survives
/// failure.
BuildResult build_scene_folder(const scene::Config& config, const BuildOptions& options,
                               const std::filesystem::path& folder, Progress& progress);

/// The part of a rank that is not the root in build_scene_folder(). Throws as that does.
void take_part_in_build(const scene::Config& config, const BuildOptions& options, const std::filesystem::path& folder,
                        Progress& progress);

/// Writes what build_scene() has made as build_scene_folder() does: the same files, beside the target and then renamed.
/// Throws Error{usage} unless `folder` is new, empty, or holds what a build wrote; Error{failure}; Cancelled.
void write_scene_folder(const BuildResult& result, const std::filesystem::path& folder, Progress& progress);

}  // namespace sparsha::pipeline
