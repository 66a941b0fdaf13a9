// The measured nodes of a whole object in the frame of the scans.
#pragma once

#include <cstddef>

#include <Eigen/Core>
#include <Eigen/LU>

#include "base/threads/progress.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

/// Calls node(place in metres, outward unit normal, number of the sheet, index of the node in it) for each measured
/// node of all sheets, sheet by sheet and row by row. Requires a scene with charts.
template <typename Node>
void for_each_chart_node(const scene::Scene& scene, Progress& progress, const Node& node) {
  const scene::SceneDescription& description = scene.description();
  const scene::Charts& charts = *description.charts;
  const Eigen::Matrix4d& m = description.scan_from_grid;
  // Normals stay across the surface when it is sheared or scaled.
  const Eigen::Matrix3d of_normals = m.topLeftCorner<3, 3>().inverse().transpose();
  for (std::size_t s = 0; s < charts.sheets.size(); ++s) {
    progress.at(static_cast<double>(s) / static_cast<double>(charts.sheets.size()));
    const scene::Sheet& sheet = charts.sheets[s];
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t index = sheet.index(i, j);
        if (!sheet.measured(index)) continue;
        const Eigen::Vector3d grid_m = charts.origin_m + charts.place_m(sheet, i, j);
        node(Eigen::Vector3d(m.topLeftCorner<3, 3>() * grid_m + m.topRightCorner<3, 1>()),
             Eigen::Vector3d((of_normals * scene::Charts::normal(sheet, i, j)).normalized()), s, index);
      }
    }
  }
}

}  // namespace sparsha::pipeline
