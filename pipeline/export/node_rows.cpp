// Bands of rows out of a scene.
#include "pipeline/export/node_rows.h"

#include <algorithm>

#include "scene/scene.h"

namespace sparsha::pipeline {

NodeRows::NodeRows(const scene::Scene& scene, bool measured_only)
    : scene_(scene), measured_only_(measured_only), lattice_(scene.description().levels.at(0)) {}

std::size_t NodeRows::locate(int i, int j) {
  if (j < first_ || j >= first_ + rows_) {
    first_ = j - j % kBand;
    rows_ = std::min(kBand, lattice_.ny - first_);
    band_ = scene_.read(0, 0, first_, lattice_.nx, rows_);
  }
  return band_.grid.lattice.index(i, j - first_);
}

bool NodeRows::known(int i, int j) {
  const scene::NodeState state = band_.grid.state[locate(i, j)];
  return measured_only_ ? state == scene::NodeState::measured : state != scene::NodeState::unknown;
}

Eigen::Vector3d NodeRows::grid_m(int i, int j) {
  const double z = lattice_.origin_m.z() + static_cast<double>(band_.grid.height_m[locate(i, j)]);
  return {lattice_.x_m(i), lattice_.y_m(j), z};
}

std::uint32_t NodeRows::rgba(int i, int j) { return band_.colour_rgba[locate(i, j)]; }

MeshCounts count_mesh(const scene::Scene& scene, bool nodes_only, Progress& progress) {
  MeshCounts counts;
  for_each_vertex(scene, nodes_only, progress, [&](const Eigen::Vector3d&, std::uint32_t) { ++counts.vertices; });
  if (!nodes_only) {
    for_each_triangle(scene, progress, [&](std::uint64_t, std::uint64_t, std::uint64_t) { ++counts.triangles; });
  }
  return counts;
}

}  // namespace sparsha::pipeline
