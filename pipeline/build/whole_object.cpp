// A mesh is sampled twice, with no point in common.
#include "pipeline/build/whole_object.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include <Eigen/LU>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/build/measured_points.h"
#include "pipeline/charts/sheet_attributes.h"
#include "pipeline/charts/uneven_points.h"
#include "pipeline/filter/voxel.h"
#include "pipeline/scan/sampled_faces.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kChartSeed = 1, kCheckSeed = 2;

/// One point in each voxel of `leaf_m`, without attributes.
Cloud thinned(const Cloud& cloud, double leaf_m, Progress& progress) {
  Cloud result;
  result.origin_m = cloud.origin_m;
  result.points = cloud.points;
  result.stations = cloud.stations;
  thin_to_voxels(result, leaf_m, progress);
  return result;
}

/// As make_charts(); points that are too uneven, as of scanners at different distances, are thinned to the smallest
/// voxels that make them even.
ChartResult charts_of_any(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                          double resolution_m, const Context& context) {
  constexpr double kFirst = 1.25, kNext = 1.3;  // of the distance of points, of the last leaf
  constexpr int kTries = 9;
  std::optional<UnevenPoints> uneven;
  try {
    return make_charts(cloud, scan_to_grid, grid, resolution_m, context);
  } catch (const UnevenPoints& found) {
    uneven = found;
  }
  double leaf_m = kFirst * uneven->spacing_m() / scale_of(scan_to_grid);
  for (int k = 0; k < kTries; ++k, leaf_m *= kNext) {
    try {
      ChartResult result =
          make_charts(thinned(cloud, leaf_m, context.progress), scan_to_grid, grid, resolution_m, context);
      context.progress.warn(fmt::format(
          "around: the points are much denser at some places than at others; for all sides they are thinned "
          "to one a cube of {}, where half of them were {} apart (the filter 'voxel' chooses another)",
          length_text(leaf_m), length_text(uneven->spacing_m() / scale_of(scan_to_grid))));
      return result;
    } catch (const UnevenPoints&) {
      continue;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      break;  // voxels as wide as walls are thick leave no surface
    }
  }
  throw UnevenPoints(*uneven);
}

ChartResult charts_of_points(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                             const scene::Config& config, const Context& context) {
  ChartResult result = charts_of_any(cloud, scan_to_grid, grid, config.haptics.resolution_m, context);
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
