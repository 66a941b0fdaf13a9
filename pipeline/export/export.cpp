// The ending tells the format.
#include "pipeline/export/export.h"

#include <algorithm>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/base/files.h"
#include "pipeline/export/formats.h"
#include "pipeline/scene/layer_file.h"

namespace sparsha::pipeline {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

void export_scene(const Scene& scene, const std::filesystem::path& file, bool nodes_only, Progress& progress) {
  const std::string ending = lower(file.extension().string());
  const std::string shown = file.string();
  const bool raster = ending == ".tif" || ending == ".tiff" || ending == ".png";
  if (!raster && ending != ".ply" && ending != ".obj" && ending != ".xyz") {
    throw Error(ErrorKind::usage, {shown, 0, 0}, "the ending names no export format",
                "expected .ply, .obj, .xyz, .tif or .png");
  }
  if (raster && nodes_only) {
    throw Error(ErrorKind::usage, {shown, 0, 0}, "a raster has no separate nodes",
                "expected .ply, .obj or .xyz with --nodes");
  }
  progress.begin("export");
  AtomicPath target(file);
  const std::filesystem::path& to = target.temporary();
  if (ending == ".ply") {
    export_ply(scene, to, shown, nodes_only, progress);
  } else if (ending == ".obj") {
    export_obj(scene, to, shown, nodes_only, progress);
  } else if (ending == ".xyz") {
    export_xyz(scene, to, shown, nodes_only, progress);
  } else if (ending == ".png") {
    export_png(scene, to, shown, progress);
  } else {
    export_tif(scene, to, shown, progress);
  }
  if (raster) {
    const SceneDescription& description = scene.description();
    // .tif -> .tfw, .png -> .pgw
    std::filesystem::path beside = file;
    beside.replace_extension(ending == ".png" ? ".pgw" : ".tfw");
    write_file(beside, world_file(description.levels.at(0), description.scan_from_grid));
    if (!keeps_scan_axes(description.scan_from_grid)) {
      progress.warn(shown + ": x and y are not the scan's axes, so the raster is in the scene's grid frame");
    }
  }
  target.commit();
  progress.finish();
}

}  // namespace sparsha::pipeline
