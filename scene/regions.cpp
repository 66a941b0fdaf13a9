#include "scene/regions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {

std::optional<std::array<double, 4>> part_box(const Scene& scene, const PartConfig& part) {
  const SceneDescription& description = scene.description();
  if (!description.region_from_grid) return part.box_m;
  const Eigen::Matrix4d& region_from_grid = *description.region_from_grid;
  const int coarsest = static_cast<int>(description.levels.size()) - 1;
  const DepthGrid grid = scene.read_level(coarsest).grid;
  const Lattice& lattice = grid.lattice;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<double, 4> box{kFar, kFar, -kFar, -kFar};
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const auto height_m = static_cast<double>(grid.height_m[lattice.index(i, j)]);
      if (!std::isfinite(height_m)) continue;
      const double x_m = lattice.x_m(i);
      const double y_m = lattice.y_m(j);
      const Eigen::Vector4d place = region_from_grid * Eigen::Vector4d(x_m, y_m, lattice.origin_m.z() + height_m, 1.0);
      if (!in_box(part.box_m, place.x(), place.y())) continue;
      box = {std::min(box[0], x_m), std::min(box[1], y_m), std::max(box[2], x_m), std::max(box[3], y_m)};
    }
  if (!(box[0] <= box[2])) return std::nullopt;
  return box;
}

}  // namespace sparsha::pipeline
