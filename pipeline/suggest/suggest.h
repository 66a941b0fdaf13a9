// A configuration for scans nobody has described yet: guessed units, orientation and spacing, each with its reason.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "scene/config.h"

namespace sparsha::pipeline {

struct Suggestion {
  std::string yaml;  ///< commented; paths relative to `folder`
  Config config;     ///< the same, parsed
};

/// Reads the scans and guesses. `folder` is where the configuration will be written, empty for the present one: paths
/// are relative to it, absolute where they are given so. Throws Error{input}.
[[nodiscard]] Suggestion suggest_config(const std::vector<std::filesystem::path>& scans,
                                        const std::filesystem::path& folder, Progress& progress);

}  // namespace sparsha::pipeline
