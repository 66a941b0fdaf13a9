// Clouds and error statistics for the projection's tests.
#include "tests/support/clouds.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>

namespace sparsha::test {

pipeline::Cloud make_cloud(const Points& points, const Eigen::Vector3d& origin_m) {
  pipeline::Cloud cloud;
  cloud.origin_m = origin_m;
  cloud.points->reserve(points.size());
  for (const std::array<double, 3>& p : points) {
    cloud.points->push_back({static_cast<float>(p[0] - origin_m.x()), static_cast<float>(p[1] - origin_m.y()),
                             static_cast<float>(p[2] - origin_m.z())});
  }
  return cloud;
}

pipeline::Projection project_cloud(const pipeline::Cloud& cloud, const scene::GridConfig& config,
                                   const Eigen::Matrix4d& scan_to_grid, unsigned threads) {
  ThreadPool pool(threads);
  Progress progress;
  return pipeline::project(cloud, scan_to_grid, config, 0.00005, {pool, progress});
}

Errors judge(const scene::DepthGrid& grid, const HeightFunction& truth,
             const std::function<bool(double, double)>& counts) {
  Errors errors;
  std::vector<double> found;
  std::size_t judged = 0;
  double squares = 0.0;
  for (int j = 0; j < grid.lattice.ny; ++j) {
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const double x = grid.lattice.x_m(i);
      const double y = grid.lattice.y_m(j);
      if (!counts(x, y)) continue;
      ++judged;
      const std::size_t node = grid.lattice.index(i, j);
      if (grid.state[node] != scene::NodeState::measured) continue;
      const double height = static_cast<double>(grid.height_m[node]) + grid.lattice.origin_m.z();
      const double error = std::abs(height - truth(x, y));
      found.push_back(error);
      squares += error * error;
      errors.over_2mm += error > 0.002 ? 1.0 : 0.0;
      errors.over_5mm += error > 0.005 ? 1.0 : 0.0;
    }
  }
  if (found.empty()) return errors;
  const auto count = static_cast<double>(judged);
  errors.measured = static_cast<double>(found.size()) / count;
  errors.rms_m = std::sqrt(squares / static_cast<double>(found.size()));
  errors.over_2mm /= count;
  errors.over_5mm /= count;
  std::sort(found.begin(), found.end());
  errors.p99_m = found[found.size() - 1 - found.size() / 100];
  errors.worst_m = found.back();
  return errors;
}

}  // namespace sparsha::test
