// Bands of rows out of a scene.
#include "pipeline/export/node_rows.h"

#include <algorithm>
#include <numbers>

#include "scene/scene.h"

namespace sparsha::pipeline {

NodeRows::NodeRows(const scene::Scene& scene, Nodes nodes)
    : scene_(scene), nodes_(nodes), lattice_(scene.description().levels.at(0)) {
  const scene::SceneDescription& description = scene.description();
  if (description.config.unroll)
    unrolling_.emplace(*description.config.unroll, description.config.orientation.scan_to_grid);
}

Eigen::Vector3d NodeRows::scan_m(const Eigen::Vector3d& grid_m) const {
  if (unrolling_) return unrolling_->scan(grid_m);
  const Eigen::Matrix4d& m = scene_.description().scan_from_grid;
  return m.topLeftCorner<3, 3>() * grid_m + m.topRightCorner<3, 1>();
}

bool NodeRows::once_around(int i, int j) const {
  if (!unrolling_) return true;
  // Half a cell beyond the seam, so that no gap is left there.
  const double x_m = lattice_.x_m(i), y_m = lattice_.y_m(j);
  const double nearer_m = std::abs(x_m) - 0.5 * lattice_.spacing_m;
  return nearer_m <= 0.0 || std::abs(unrolling_->angle({std::copysign(nearer_m, x_m), y_m, 0.0})) <= std::numbers::pi;
}

void NodeRows::load(int j) {
  if (j >= first_ && j < first_ + rows_) return;
  first_ = j - j % kBand;
  rows_ = std::min(kBand, lattice_.ny - first_);
  const int beside = nodes_ == Nodes::of_cells ? 1 : 0;
  lowest_ = std::max(first_ - beside, 0);
  const int end = std::min(first_ + rows_ + beside, lattice_.ny);
  band_ = scene_.read(0, 0, lowest_, lattice_.nx, end - lowest_);
}

std::size_t NodeRows::locate(int i, int j) {
  load(j);
  return band_.grid.lattice.index(i, j - lowest_);
}

bool NodeRows::chosen(int i, int j) const {
  if (i < 0 || i >= lattice_.nx || j < 0 || j >= lattice_.ny || !once_around(i, j)) return false;
  const scene::NodeState state = band_.grid.state[band_.grid.lattice.index(i, j - lowest_)];
  return nodes_ == Nodes::measured ? state == scene::NodeState::measured : state != scene::NodeState::unknown;
}

bool NodeRows::known(int i, int j) {
  load(j);
  if (!chosen(i, j)) return false;
  if (nodes_ != Nodes::of_cells) return true;
  for (const int across : {-1, 1}) {
    if (!chosen(i + across, j)) continue;
    for (const int along : {-1, 1})
      if (chosen(i, j + along) && chosen(i + across, j + along)) return true;
  }
  return false;
}

Eigen::Vector3d NodeRows::grid_m(int i, int j) {
  const double z = lattice_.origin_m.z() + static_cast<double>(band_.grid.height_m[locate(i, j)]);
  return {lattice_.x_m(i), lattice_.y_m(j), z};
}

std::uint32_t NodeRows::rgba(int i, int j) { return band_.colour_rgba[locate(i, j)]; }

MeshCounts count_mesh(const scene::Scene& scene, Nodes nodes, Progress& progress) {
  MeshCounts counts;
  for_each_vertex(scene, nodes, progress, [&](const Eigen::Vector3d&, std::uint32_t) { ++counts.vertices; });
  if (nodes == Nodes::of_cells) {
    for_each_triangle(scene, progress, [&](std::uint64_t, std::uint64_t, std::uint64_t) { ++counts.triangles; });
  }
  return counts;
}

}  // namespace sparsha::pipeline
