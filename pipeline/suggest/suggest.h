// A configuration for scans nobody has described yet: guessed units, orientation and spacing, each with its reason.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "pipeline/orient/thumbnails.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {

struct Suggestion {
  std::string yaml;      ///< commented; paths relative to `folder`
  scene::Config config;  ///< the same, parsed
  /// Of the object's six sides, the one that was taken first, where another may as well be its front; else empty.
  std::vector<Thumbnail> sides;
};

/// What the user knows of the scans.
struct SuggestOptions {
  std::optional<Eigen::Vector3d> up{};  ///< scan frame; of any length but zero
  /// Of what the first look may take, bytes; 0 = no limit. It changes nothing of what is found; a mesh that needs more
  /// is refused.
  std::uint64_t memory_bytes = 0;
  /// The user has settings of their own, which may succeed where no view and spacing that is tried shows a surface:
  /// then that is a warning, no error.
  bool settings_follow = false;
  /// Damaged chunks of LAZ are left out and said, in place of an error.
  bool whole_chunks_only = false;
};

/// Reads the scans and guesses. `folder` is where the configuration will be written, empty for the present one: paths
/// are relative to it, absolute where they are given so. Throws Error{input}.
[[nodiscard]] Suggestion suggest_config(const std::vector<std::filesystem::path>& scans,
                                        const std::filesystem::path& folder, Progress& progress,
                                        const SuggestOptions& options = {});

}  // namespace sparsha::pipeline
