// One writer a format, behind export_scene(). `file` is written to, `shown` is the name in messages.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

void export_ply(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress);
void export_obj(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress);
void export_xyz(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool nodes_only,
                Progress& progress);
/// `haptics`: with maps of what is felt, see glb_maps.h.
void export_glb(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool haptics,
                Progress& progress);
void export_tif(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown,
                Progress& progress);
void export_png(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown,
                Progress& progress);

/// Measured nodes of all charts with their outward normals and the number of their sheet, by the ending of `shown`:
/// .ply, .obj or .xyz. Requires a scene with charts.
void export_chart_nodes(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown,
                        Progress& progress);

/// Height that a raster stores for a node, metres: z of the scan frame when x and y stay the scan's axes, else of the
/// grid frame.
[[nodiscard]] double raster_height(const scene::Scene& scene, const Eigen::Vector3d& grid_m);

}  // namespace sparsha::pipeline
