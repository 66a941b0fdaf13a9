// The ending tells the format.
#include "pipeline/export/export.h"

#include <optional>

#include "base/error.h"
#include "base/files/files.h"
#include "base/text/lower_case.h"
#include "pipeline/export/formats.h"
#include "scene/folder/layer_file.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

bool is_raster(const std::string& ending) { return ending == ".tif" || ending == ".tiff" || ending == ".png"; }

}  // namespace

void check_export(const std::filesystem::path& file, bool nodes_only, bool haptics) {
  const std::string ending = ending_of(file);
  if (!is_raster(ending) && ending != ".ply" && ending != ".obj" && ending != ".xyz" && ending != ".glb") {
    throw Error(ErrorKind::usage, {file.string(), 0, 0}, "the ending names no export format",
                "expected .ply, .obj, .xyz, .glb, .tif, .png, or .stl or .3mf for a replica");
  }
  if ((is_raster(ending) || ending == ".glb") && nodes_only) {
    throw Error(ErrorKind::usage, {file.string(), 0, 0},
                ending == ".glb" ? "a GLB has no separate nodes" : "a raster has no separate nodes",
                "expected .ply, .obj or .xyz with --nodes");
  }
  if (haptics && ending != ".glb") {
    throw Error(ErrorKind::usage, {file.string(), 0, 0}, "only a GLB has maps of what is felt",
                "expected .glb with --haptics");
  }
}

std::filesystem::path world_file_of(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (!is_raster(ending)) return {};
  std::filesystem::path beside = file;
  return beside.replace_extension(ending == ".png" ? ".pgw" : ".tfw");
}

void export_scene(const scene::Scene& scene, const std::filesystem::path& file, bool nodes_only, Progress& progress,
                  bool haptics) {
  check_export(file, nodes_only, haptics);
  const std::string ending = ending_of(file);
  const std::string shown = file.string();
  progress.begin("export");
  AtomicPath target(file);
  const std::filesystem::path& to = target.temporary();
  if (nodes_only && scene.description().charts) {
    export_chart_nodes(scene, to, shown, progress);
  } else if (ending == ".ply") {
    export_ply(scene, to, shown, nodes_only, progress);
  } else if (ending == ".obj") {
    export_obj(scene, to, shown, nodes_only, progress);
  } else if (ending == ".xyz") {
    export_xyz(scene, to, shown, nodes_only, progress);
  } else if (ending == ".glb") {
    export_glb(scene, to, shown, haptics, progress);
  } else if (ending == ".png") {
    export_png(scene, to, shown, progress);
  } else {
    export_tif(scene, to, shown, progress);
  }
  if (is_raster(ending)) {
    const scene::SceneDescription& description = scene.description();
    write_file(world_file_of(file), scene::world_file(description.levels.at(0), description));
    if (!scene::keeps_scan_axes(description)) {
      progress.warn(shown + ": x and y are not the scan's axes, so the raster is in the scene's grid frame");
    }
  }
  target.commit();
  progress.finish();
}

}  // namespace sparsha::pipeline
