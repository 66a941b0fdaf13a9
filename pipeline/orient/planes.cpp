// The only file of this folder that sees PCL. A plane's points must lie on it and face along it, so that a slice
// through a solid is no plane.
#include "pipeline/orient/planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/impl/ransac.hpp>
#include <pcl/sample_consensus/impl/sac_model_normal_plane.hpp>

#include "pipeline/scan/pcl_trees.hpp"
#include "pipeline/scan/quiet_pcl.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNeighbourhoods = 2.0;  // distances: noise of half of one turns normals by a few degrees only
constexpr unsigned kMostNeighbours = 64;
constexpr double kNormalWeight = 0.05;  // per radian, beside distances of a thing of size 1
constexpr int kMostIterations = 2000;
constexpr std::size_t kEnough = 4000;  // points to find a plane by; then all are asked

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

Normals::Ptr normals_of(const Points::Ptr& points, double radius) {
  Normals::Ptr normals(new Normals);
  normals->resize(points->size());
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(points);
  pcl::Indices near;
  std::vector<float> squares;
  for (std::size_t i = 0; i < points->size(); ++i) {
    tree.radiusSearch((*points)[i], radius, near, squares, kMostNeighbours);
    Eigen::Vector4f plane = Eigen::Vector4f::Zero();
    float curvature = 0.0F;
    if (!pcl::computePointNormal(*points, near, plane, curvature)) plane.setZero();
    (*normals)[i] = pcl::Normal(plane.x(), plane.y(), plane.z());
  }
  return normals;
}

// The least squares plane of some points.
FacePlane fitted(const Points& points, const pcl::Indices& inliers) {
  FacePlane plane;
  plane.centre.setZero();
  for (const pcl::index_t i : inliers) {
    plane.inliers.push_back(static_cast<std::size_t>(i));
    plane.centre += points[static_cast<std::size_t>(i)].getVector3fMap().cast<double>();
  }
  plane.centre /= static_cast<double>(inliers.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const pcl::index_t i : inliers) {
    const Eigen::Vector3d d = points[static_cast<std::size_t>(i)].getVector3fMap().cast<double>() - plane.centre;
    covariance += d * d.transpose();
  }
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0).normalized();
  return plane;
}

}  // namespace

std::optional<FacePlane> largest_plane(const std::vector<Eigen::Vector3f>& points, double distance) {
  if (points.size() < 4) return std::nullopt;
  const QuietPcl quiet;  // points without a plane, and samples of three on a line, are no errors here
  Points::Ptr cloud(new Points);
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->push_back({p.x(), p.y(), p.z()});
  using Model = pcl::SampleConsensusModelNormalPlane<pcl::PointXYZ, pcl::Normal>;
  const Normals::Ptr normals = normals_of(cloud, kNeighbourhoods * distance);
  const auto model = std::make_shared<Model>(cloud);
  model->setInputNormals(normals);
  model->setNormalDistanceWeight(kNormalWeight);
  pcl::Indices some;
  const std::size_t step = std::max<std::size_t>(1, cloud->size() / kEnough);
  for (std::size_t i = 0; i < cloud->size(); i += step) some.push_back(static_cast<pcl::index_t>(i));
  const auto some_model = std::make_shared<Model>(cloud, some);
  some_model->setInputNormals(normals);
  some_model->setNormalDistanceWeight(kNormalWeight);
  pcl::RandomSampleConsensus<pcl::PointXYZ> consensus(some_model, distance);
  consensus.setMaxIterations(kMostIterations);
  if (!consensus.computeModel()) return std::nullopt;
  Eigen::VectorXf coefficients;
  consensus.getModelCoefficients(coefficients);
  pcl::Indices inliers;
  model->selectWithinDistance(coefficients, distance, inliers);
  // RANSAC's plane goes through three noisy points; that of all its points is better, and has more of them.
  for (int round = 0; round < 3 && inliers.size() >= 3; ++round) {
    const FacePlane plane = fitted(*cloud, inliers);
    Eigen::VectorXf refined(4);
    for (int axis = 0; axis < 3; ++axis) refined[axis] = static_cast<float>(plane.normal[axis]);
    refined[3] = static_cast<float>(-plane.normal.dot(plane.centre));
    pcl::Indices more;
    model->selectWithinDistance(refined, distance, more);
    if (more.size() < inliers.size()) break;
    inliers = std::move(more);
  }
  if (inliers.size() < 3) return std::nullopt;
  std::sort(inliers.begin(), inliers.end());
  return fitted(*cloud, inliers);
}

}  // namespace sparsha::pipeline
