// One writer a format, behind export_scene(). `file` is written to, `shown` is the name in messages.
#pragma once

#include <filesystem>
#include <string>

#include "base/progress.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

void export_ply(const Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress);
void export_obj(const Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress);
void export_xyz(const Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress);
void export_tif(const Scene& scene, const std::filesystem::path& file, const std::string& shown, Progress& progress);
void export_png(const Scene& scene, const std::filesystem::path& file, const std::string& shown, Progress& progress);

/// Height that a raster stores for a node, metres: z of the scan frame when x and y stay the scan's axes, else of the
/// grid frame.
[[nodiscard]] double raster_height(const Scene& scene, const Eigen::Vector3d& grid_m);

}  // namespace sparsha::pipeline
