// GLB of the front view: one mesh, its colours at the vertices, and what is felt as pictures.
#include "base/error.h"
#include "pipeline/export/formats.h"
#include "pipeline/export/glb_file.h"
#include "pipeline/export/glb_maps.h"
#include "pipeline/export/node_rows.h"
#include "pipeline/export/output.hpp"
#include "pipeline/export/vertex_colour.hpp"

namespace sparsha::pipeline {
namespace {

/// Vertices are float32 relative to this place, which the node's matrix moves and turns to the viewer's axes.
Eigen::Vector3d middle_of(const scene::Scene& scene) {
  const scene::SceneDescription& description = scene.description();
  const scene::Lattice& lattice = description.levels.at(0);
  const Eigen::Vector3d grid(0.5 * (lattice.x_m(0) + lattice.x_m(lattice.nx - 1)),
                             0.5 * (lattice.y_m(0) + lattice.y_m(lattice.ny - 1)),
                             0.5 * (description.height_min_m + description.height_max_m));
  return NodeRows(scene, Nodes::of_cells).scan_m(grid).array().round();
}

void put_places_in_pictures(const scene::Scene& scene, Output& output) {
  NodeRows rows(scene, Nodes::of_cells);
  const scene::Lattice& lattice = rows.lattice();
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      if (!rows.known(i, j)) continue;
      output.put(static_cast<float>((i + 0.5) / lattice.nx));
      output.put(static_cast<float>((lattice.ny - 1 - j + 0.5) / lattice.ny));
    }
  }
}

}  // namespace

void export_glb(const scene::Scene& scene, const std::filesystem::path& file, const std::string& shown, bool haptics,
                Progress& progress) {
  const Eigen::Vector3d middle = middle_of(scene);
  const auto local = [&](const Eigen::Vector3d& p) { return Eigen::Vector3f((p - middle).cast<float>()); };
  const bool colour = scene.description().has_colour;
  const MeshCounts counts = count_mesh(scene, Nodes::of_cells, progress);
  if (counts.triangles == 0) {
    throw Error(ErrorKind::input, {shown, 0, 0},
                "no cell of the scene is known at its four corners, so there is no mesh",
                "expected a scene with more of its surface measured, or .ply or .xyz for its points");
  }
  GlbBox box;
  for_each_vertex(scene, Nodes::of_cells, progress,
                  [&](const Eigen::Vector3d& p, std::uint32_t) { box.add(local(p)); });
  const std::vector<HapticMap> maps = haptics ? haptic_maps(scene, progress) : std::vector<HapticMap>();
  const GlbDescription description(counts, box, middle, viewer_from_scan(scene), colour, maps);
  Output output(file, shown);
  begin_glb(description, output, shown);
  for_each_vertex(scene, Nodes::of_cells, progress, [&](const Eigen::Vector3d& p, std::uint32_t) {
    const Eigen::Vector3f q = local(p);
    for (int axis = 0; axis < 3; ++axis) output.put(q[axis]);
  });
  if (colour) {
    for_each_vertex(scene, Nodes::of_cells, progress,
                    [&](const Eigen::Vector3d&, std::uint32_t rgba) { put_glb_colour(output, rgba); });
  }
  if (!maps.empty()) put_places_in_pictures(scene, output);
  for_each_triangle(scene, progress, [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    for (const std::uint64_t corner : {a, b, c}) output.put(static_cast<std::uint32_t>(corner));
  });
  for (const HapticMap& map : maps) put_padded(output, map.png);
  output.close();
}

}  // namespace sparsha::pipeline
