// PCL stays here.
#include "bench/pipeline/pcl_mls.h"

#include <pcl/point_types.h>
#include <pcl/kdtree/impl/kdtree_flann.hpp>
#include <pcl/search/impl/kdtree.hpp>
#include <pcl/surface/impl/mls.hpp>

namespace sparsha::bench {

std::vector<std::array<double, 3>> by_pcl_mls(const pipeline::Cloud& cloud, double radius_m) {
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointXYZ> fitter;
  fitter.setInputCloud(cloud.points);
  fitter.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  fitter.setSearchRadius(radius_m);
  fitter.setPolynomialOrder(2);
  fitter.setComputeNormals(false);
  pcl::PointCloud<pcl::PointXYZ> smoothed;
  fitter.process(smoothed);
  std::vector<std::array<double, 3>> points;
  points.reserve(smoothed.size());
  for (const pcl::PointXYZ& p : smoothed)
    points.push_back({static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
  return points;
}

}  // namespace sparsha::bench
