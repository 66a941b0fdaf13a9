#include "pipeline/check/chart_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "scene/depth_grid.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::pipeline {
namespace {

float mean_about(const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal, double reach_m,
                 const std::vector<scene::SurfaceNode>& about) {
  double sum = 0.0, weights = 0.0;
  for (const scene::SurfaceNode& point : about) {
    const double way_2 = (point.place_m - place_m).squaredNorm();
    if (way_2 > reach_m * reach_m || point.normal.dot(normal) < scene::SurfaceNode::kSameSide) continue;
    const double weight = 1.0 - way_2 / (reach_m * reach_m);
    sum += weight * point.value;
    weights += weight;
  }
  return weights > 0.0 ? static_cast<float>(sum / weights) : scene::kUnknownHeight;
}

}  // namespace

void add_errors(scene::Charts& charts, const ChartCheck& check, const Context& context) {
  constexpr double kPoints = 12.0;
  if (check.places.empty()) return;
  // Two charts or three have most places: their nodes are some 1.8 times the spacings' squares of the surface.
  constexpr double kNodesPerSquare = 1.8;
  const double squares = static_cast<double>(charts.measured_nodes()) / kNodesPerSquare;
  const double per_point = squares / static_cast<double>(check.places.size());
  const double reach_m = charts.spacing_m * std::max(1.5, std::sqrt(kPoints * per_point / 3.14159265358979323846));
  std::vector<scene::SurfaceNode> points;
  points.reserve(check.places.size());
  for (const ChartCheck::Place& place : check.places)
    points.push_back({place.place_m.cast<double>(), place.normal.cast<double>(), 1.0,
                      std::abs(static_cast<double>(place.distance_m))});
  const scene::SurfaceNodes nodes(std::move(points), reach_m);
  context.pool.for_ranges(charts.sheets.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<scene::SurfaceNode> about;
    for (std::size_t s = begin; s < end; ++s) {
      scene::Sheet& sheet = charts.sheets[s];
      sheet.error_m.assign(sheet.count(), scene::kUnknownHeight);
      Eigen::Vector3i cube = Eigen::Vector3i::Zero();
      about.clear();
      bool looked = false;
      for (int j = 0; j < sheet.ny; ++j) {
        for (int i = 0; i < sheet.nx; ++i) {
          const std::size_t node = sheet.index(i, j);
          if (!sheet.measured(node)) continue;
          const Eigen::Vector3d place_m = charts.place_m(sheet, i, j);
          if (const Eigen::Vector3i here = nodes.cube_of(place_m); !looked || here != cube) {
            nodes.near(here, about);
            cube = here;
            looked = true;
          }
          sheet.error_m[node] = mean_about(place_m, scene::Charts::normal(sheet, i, j), reach_m, about);
        }
      }
    }
  });
}

}  // namespace sparsha::pipeline
