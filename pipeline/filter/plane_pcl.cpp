// PCL's search for a plane: its RANSAC and its model, as pcl::SACSegmentation puts them together.
#include <pcl/point_types.h>
#include <pcl/sample_consensus/impl/ransac.hpp>
#include <pcl/sample_consensus/impl/sac_model_perpendicular_plane.hpp>

#include <numbers>

#include "pipeline/filter/plane.h"
#include "pipeline/scan/pcl_trees.hpp"
#include "pipeline/scan/quiet_pcl.h"

namespace sparsha::pipeline {

Eigen::Vector4d plane_by_pcl(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& direction,
                             double max_angle_deg, double distance) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  const auto plane = std::make_shared<pcl::SampleConsensusModelPerpendicularPlane<pcl::PointXYZ>>(cloud);
  plane->setAxis(direction.cast<float>());
  plane->setEpsAngle(max_angle_deg * std::numbers::pi / 180.0);
  pcl::RandomSampleConsensus<pcl::PointXYZ> consensus(plane, distance);  // seeded by a constant
  consensus.setProbability(0.9999);
  consensus.setMaxIterations(10000);
  const QuietPcl quiet;
  if (!consensus.computeModel()) return Eigen::Vector4d::Zero();
  Eigen::VectorXf coefficients;
  consensus.getModelCoefficients(coefficients);
  return coefficients.head<4>().cast<double>();
}

}  // namespace sparsha::pipeline
