// PCL's search for a plane, from its template's source: linking libpcl_segmentation would slow down every start.
#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/impl/sac_segmentation.hpp>

#include <numbers>

#include "pipeline/filter/plane.h"

namespace sparsha::pipeline {

Eigen::Vector4d plane_by_pcl(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& direction,
                             double max_angle_deg, double distance) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  pcl::SACSegmentation<pcl::PointXYZ> search;  // seeded by a constant unless it is asked not to be
  search.setModelType(pcl::SACMODEL_PERPENDICULAR_PLANE);
  search.setMethodType(pcl::SAC_RANSAC);
  search.setAxis(direction.cast<float>());
  search.setEpsAngle(max_angle_deg * std::numbers::pi / 180.0);
  search.setDistanceThreshold(distance);
  search.setProbability(0.9999);
  search.setMaxIterations(10000);
  search.setOptimizeCoefficients(false);
  search.setInputCloud(cloud);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients coefficients;
  // It prints what the caller learns from the result.
  const pcl::console::VERBOSITY_LEVEL before = pcl::console::getVerbosityLevel();
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  search.segment(inliers, coefficients);
  pcl::console::setVerbosityLevel(before);
  if (coefficients.values.size() != 4) return Eigen::Vector4d::Zero();
  return Eigen::Map<const Eigen::Vector4f>(coefficients.values.data()).cast<double>();
}

}  // namespace sparsha::pipeline
