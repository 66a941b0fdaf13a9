// A mesh is sampled twice, with no point in common.
#include "pipeline/build/whole_object.h"

#include <cmath>
#include <cstdint>

#include <Eigen/LU>

#include "pipeline/build/measured_points.h"
#include "pipeline/charts/sheet_attributes.h"
#include "pipeline/scan/sampled_faces.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kChartSeed = 1, kCheckSeed = 2;

ChartResult charts_of_points(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                             const scene::Config& config, const Context& context) {
  ChartResult result = make_charts(cloud, scan_to_grid, grid, config.haptics.resolution_m, context);
  add_attributes(result.charts, cloud, scan_to_grid,
                 {config.grid.colour, config.grid.intensity, result.point_spacing_m, result.noise_m}, context);
  return result;
}

}  // namespace

double scale_of(const Eigen::Matrix4d& scan_to_grid) {
  return std::cbrt(std::abs(scan_to_grid.topLeftCorner<3, 3>().determinant()));
}

ChartResult charts_of(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                      double front_spacing_m, const scene::Config& config, const Context& context) {
  if (grid.bounds_m)
    context.progress.warn("grid.bounds_m bounds the front view alone; the filter 'crop' bounds the whole object");
  if (cloud.faces.empty()) return charts_of_points(cloud, scan_to_grid, grid, config, context);
  scene::GridConfig of_mesh = grid;
  if (grid.size == 0) of_mesh.spacing_m = front_spacing_m;
  const double spacing_m = front_spacing_m / scale_of(scan_to_grid);
  const Cloud sampled =
      sample_faces(cloud, kPlacesOfSpacing * spacing_m, kChartSeed, config.grid.colour || config.grid.intensity);
  return charts_of_points(sampled, scan_to_grid, of_mesh, config, context);
}

ChartCheck check_charts_of(Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                           const scene::Config& config, const Context& context) {
  restore_measured(cloud);
  if (cloud.faces.empty()) return check_charts(cloud, scan_to_grid, charts, *config.check, context);
  const double spacing_m = kPlacesOfSpacing * charts.spacing_m / scale_of(scan_to_grid);
  return check_charts(sample_faces(cloud, spacing_m, kCheckSeed), scan_to_grid, charts, *config.check, context);
}

}  // namespace sparsha::pipeline
