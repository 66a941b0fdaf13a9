// Where the points of a scan are, and how the object stands.
#pragma once

#include <filesystem>

#include "scene/config/config.h"
#include "scene/config/reader.h"

namespace sparsha::scene {

/// An element of `scans`. Throws Error with line and column.
[[nodiscard]] ScanConfig parse_scan(const yaml::Node& node, const std::filesystem::path& folder);

/// `orientation`. Throws Error with line and column.
[[nodiscard]] OrientationConfig parse_orientation(const yaml::Node& node);

}  // namespace sparsha::scene
