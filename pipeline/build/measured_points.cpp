#include "pipeline/build/measured_points.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

// What became of a point that an outlier filter took away: the cross-check counts it unless the view does not see it.
PointClass class_of(const Eigen::Vector3d& grid_point_m, const scene::DepthGrid& grid, double gap_m) {
  const scene::Lattice& lattice = grid.lattice;
  const double u = (grid_point_m.x() - lattice.origin_m.x()) / lattice.spacing_m;
  const double v = (grid_point_m.y() - lattice.origin_m.y()) / lattice.spacing_m;
  if (!(u >= -0.5 && v >= -0.5 && u <= lattice.nx - 0.5 && v <= lattice.ny - 0.5)) return PointClass::outside;
  const int i = std::clamp(static_cast<int>(std::lround(u)), 0, lattice.nx - 1);
  const int j = std::clamp(static_cast<int>(std::lround(v)), 0, lattice.ny - 1);
  const auto height = static_cast<double>(grid.height_m[lattice.index(i, j)]);
  const double depth = lattice.origin_m.z() + height - grid_point_m.z();
  return depth > gap_m ? PointClass::occluded : PointClass::outlier;  // an unknown height occludes nothing
}

}  // namespace

void restore_measured(Cloud& cloud) {
  for (std::size_t n = 0; n < cloud.measured.size(); ++n) {
    std::copy_n(cloud.measured[n].data(), 3, cloud.xyz1() + 4 * n);
  }
  cloud.measured = {};
}

void add_outliers(Cloud& cloud, const Cloud& removed, const Eigen::Matrix4d& scan_to_grid, Projection& projection) {
  const std::size_t first = cloud.size();
  if (removed.size() == 0) return;
  cloud.resize_points(first + removed.size());
  for (std::size_t n = 0; n < removed.size(); ++n) {
    const float* point = removed.xyz1() + 4 * n;
    std::copy_n(point, 3, cloud.xyz1() + 4 * (first + n));
    const Eigen::Vector3d scan = removed.origin_m + Eigen::Map<const Eigen::Vector3f>(point).cast<double>();
    const Eigen::Vector3d grid = (scan_to_grid * scan.homogeneous()).head<3>();
    projection.point_class.push_back(class_of(grid, projection.grid, projection.gap_m));
  }
}

}  // namespace sparsha::pipeline
