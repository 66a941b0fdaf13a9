// Heights and mask of a level as they are on disk, held against what scene.yaml says of them.
#pragma once

#include <filesystem>
#include <string>

#include "scene/depth_grid.h"
#include "scene/folder/layer_file.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// Reads height.tif and mask.tif of a level's `folder` into `layers.grid`, whose lattice is the region's. A node whose
/// mask is not 1 or 2 and a height that is no number become unknown; the latter are counted where the mask calls them
/// known. Throws Error{input} as read_layer() does, and with the node of a known height that lies beyond the range that
/// scene.yaml gives: such a file is damaged, or of another scene.
void read_heights(const std::filesystem::path& folder, const LayerRegion& region, const SceneDescription& scene,
                  Layers& layers);

/// What is said of heights that are no numbers though the mask calls them known; empty where there are none.
[[nodiscard]] std::string doubt_of_heights(const Layers& layers, int level);

}  // namespace sparsha::scene
