// level.vrt of a level's folder: all layers as bands of one raster with its place, for GDAL and what is built on it.
#pragma once

#include <string>
#include <vector>

#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// A GDAL virtual raster over the files of the layers `names` (as scene.yaml lists them) beside it. Heights and their
/// envelope have the grid's z as offset; colour is four bands. The same scene gives the same bytes.
[[nodiscard]] std::string vrt_file(const Lattice& lattice, const SceneDescription& scene,
                                   const std::vector<std::string>& names);

}  // namespace sparsha::scene
