// A cloud of PCL: outliers go, and the front becomes a depth grid.
#include <cmath>
#include <cstdio>
#include <random>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <sparsha/pcl.h>

int main() {
  // A ball of 50 mm radius, scanned with 0.1 mm noise, and some dust around it.
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr scan(new pcl::PointCloud<pcl::PointXYZRGB>);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 200000; ++i) {
    Eigen::Vector3f direction(normal(random), normal(random), normal(random));
    pcl::PointXYZRGB point;
    point.getVector3fMap() = (0.05F + 0.0001F * normal(random)) * direction.normalized();
    if (i % 1000 == 0) point.getVector3fMap() *= 1.5F + 0.2F * std::abs(normal(random));
    scan->push_back(point);
  }

  pcl::PointCloud<pcl::PointXYZRGB>::Ptr clean(new pcl::PointCloud<pcl::PointXYZRGB>);
  sparsha::StatisticalOutlierFilter<pcl::PointXYZRGB> filter;
  filter.setInputCloud(scan);
  filter.setMeanK(8);
  filter.setStddevMulThresh(3.0);
  filter.filter(*clean);

  // Seen along -x: the grid's z is the cloud's x.
  Eigen::Affine3d orientation = Eigen::Affine3d::Identity();
  orientation.linear() << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  sparsha::MongeProjection<pcl::PointXYZRGB> projection;
  projection.setInputCloud(clean);
  projection.setOrientation(orientation);
  projection.setSpacing(0.0005);
  sparsha::scene::DepthGrid grid;
  projection.compute(grid);

  double squares = 0.0;
  int nodes = 0;
  for (int j = 0; j < grid.lattice.ny; ++j)
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const double r = std::hypot(grid.lattice.x_m(i), grid.lattice.y_m(j));
      const double z = grid.lattice.origin_m.z() + static_cast<double>(grid.height_m[grid.lattice.index(i, j)]);
      if (grid.state[grid.lattice.index(i, j)] != sparsha::scene::NodeState::measured || r > 0.04) continue;
      squares += std::pow(z - std::sqrt(0.0025 - r * r), 2);
      ++nodes;
    }
  const double rms_m = std::sqrt(squares / nodes);
  std::printf("%zu of %zu points stay; %d x %d nodes, %.3f mm RMS from the ball (noise found %.3f mm)\n", clean->size(),
              scan->size(), grid.lattice.nx, grid.lattice.ny, 1e3 * rms_m, 1e3 * projection.getEstimatedNoise());
  return nodes > 10000 && rms_m < 0.0001 ? 0 : 1;
}
