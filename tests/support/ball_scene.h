// A scene with the exact charts of a ball.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <cmath>

#include "scene/charts.h"
#include "scene/scene.h"

namespace sparsha::test {

/// Six sheets of exact heights; a node's normal has a cosine of 0.4 or more with the direction of its sheet.
inline scene::Charts ball_charts(double radius_m, double spacing_m, const Eigen::Vector3d& origin_m) {
  scene::Charts charts;
  charts.spacing_m = spacing_m;
  charts.origin_m = origin_m;
  const int half = static_cast<int>(std::ceil(radius_m / spacing_m));
  for (std::size_t side = 0; side < scene::kSides; ++side) {
    scene::Sheet sheet;
    sheet.side = static_cast<scene::Side>(side);
    sheet.first_u = sheet.first_v = -half;
    sheet.nx = sheet.ny = 2 * half + 1;
    for (std::vector<float>* values : {&sheet.height_m, &sheet.slope_u, &sheet.slope_v})
      values->assign(sheet.count(), std::nanf(""));
    sheet.mask.assign(sheet.count(), 0);
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        const double u = (i - half) * spacing_m, v = (j - half) * spacing_m;
        const double w2 = radius_m * radius_m - u * u - v * v;
        if (w2 < 0.16 * radius_m * radius_m) continue;
        const std::size_t node = sheet.index(i, j);
        sheet.height_m[node] = static_cast<float>(std::sqrt(w2));
        sheet.slope_u[node] = static_cast<float>(-u / std::sqrt(w2));
        sheet.slope_v[node] = static_cast<float>(-v / std::sqrt(w2));
        sheet.mask[node] = scene::Sheet::kMeasured;
      }
    }
    charts.sheets.push_back(std::move(sheet));
  }
  return charts;
}

/// Their front view is one flat level with nodes so far apart.
inline scene::ScenePointer scene_of_charts(scene::Charts charts, const Eigen::Matrix4d& scan_from_grid,
                                           double apart_m) {
  scene::Layers layers;
  layers.grid = scene::DepthGrid(scene::Lattice{5, 4, apart_m, charts.origin_m});
  layers.grid.height_m.assign(20, 0.0F);
  layers.grid.state.assign(20, scene::NodeState::measured);
  scene::SceneDescription description;
  description.scan_from_grid = scan_from_grid;
  description.levels = {layers.grid.lattice};
  description.charts = std::make_shared<const scene::Charts>(std::move(charts));
  std::vector<scene::Layers> levels;
  levels.push_back(std::move(layers));
  return scene::make_scene(std::move(description), std::move(levels));
}

inline scene::ScenePointer ball_scene(double radius_m, double spacing_m, const Eigen::Matrix4d& scan_from_grid,
                                      const Eigen::Vector3d& origin_m = {0.1, -0.2, 0.3}) {
  return scene_of_charts(ball_charts(radius_m, spacing_m, origin_m), scan_from_grid, radius_m);
}

}  // namespace sparsha::test
