// What SCENE, CONFIG and SCAN arguments mean.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/base/progress.h"
#include "pipeline/pipeline.h"
#include "pipeline/scene/config.h"
#include "pipeline/scene/scene.h"

namespace sparsha::app {

/// True for a file whose ending says YAML.
[[nodiscard]] bool is_config(const std::filesystem::path& path);

/// One configuration file, or scans to guess one from. Throws Error.
[[nodiscard]] pipeline::Config config_from(const std::vector<std::string>& arguments,
                                           const std::vector<std::string>& settings, Progress& progress);

/// A scene folder is opened; a configuration or a scan is built in memory.
[[nodiscard]] pipeline::ScenePointer scene_from(const std::string& argument, Progress& progress);

/// "1GB", "800 MB", "123456": bytes. Throws Error{usage}.
[[nodiscard]] std::uint64_t parse_bytes(const std::string& text);

}  // namespace sparsha::app
