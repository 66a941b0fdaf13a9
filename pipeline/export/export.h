// A scene back as mesh, points or heights, in the scan's own frame.
#pragma once

#include <filesystem>

#include "base/threads/progress.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Throws Error{usage} when export_scene() would, without a scene.
void check_export(const std::filesystem::path& file, bool nodes_only, bool haptics = false);
/// What is written beside a raster: .tif -> .tfw, .png -> .pgw; empty for other endings.
[[nodiscard]] std::filesystem::path world_file_of(const std::filesystem::path& file);
/// Writes level 0 as .ply, .obj (mesh of cells whose four nodes are known; points only with `nodes_only`, measured
/// nodes; of a whole object those of all its charts, with normals), .xyz (points), .glb (mesh), .tif (heights) or .png
/// (16-bit heights), told by the ending. Atomic. Throws Error{usage} for another ending or `nodes_only` with tif or
/// png. `haptics`: a .glb with the extension MPEG_haptic_material.
void export_scene(const scene::Scene& scene, const std::filesystem::path& file, bool nodes_only, Progress& progress,
                  bool haptics = false);

}  // namespace sparsha::pipeline
