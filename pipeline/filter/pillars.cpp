#include "pipeline/filter/pillars.h"

#include <pcl/common/common.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/sample_consensus/impl/ransac.hpp>
#include <pcl/sample_consensus/impl/sac_model_cylinder.hpp>
#include <pcl/sample_consensus/impl/sac_model_plane.hpp>
#include <pcl/segmentation/impl/extract_clusters.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/numbers/statistics.h"
#include "pipeline/scan/pcl_trees.hpp"
#include "pipeline/scan/quiet_pcl.h"

namespace sparsha::pipeline {
namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

constexpr std::size_t kFewest = 60;  // points of a pillar
constexpr int kNeighbours = 12;
constexpr double kPlaneShare = 0.08;  // of all points that a wall or floor holds at least
constexpr double kPlaneWidth = 0.25;  // its width over its length at least: the front of a cylinder is a strip
constexpr int kMostPlanes = 6;
constexpr int kMostPillars = 64;         // of one cluster
constexpr double kPlaneDistance = 0.35;  // of the points' spacing
constexpr double kCylinderDistance = 0.35;
constexpr double kClusterDistance = 2.5;
constexpr double kSlender = 2.5;    // length over radius
constexpr double kOwnShare = 0.15;  // of what is left of a cluster
constexpr double kOwnRadius = 1.5;
constexpr double kAlikeRadius = 0.7;  // of two pieces of one pillar

template <typename Point>
std::shared_ptr<pcl::PointCloud<Point>> chosen(const pcl::PointCloud<Point>& cloud, const std::vector<int>& indices) {
  auto some = std::make_shared<pcl::PointCloud<Point>>();
  for (const int i : indices) some->push_back(cloud[static_cast<std::size_t>(i)]);
  return some;
}

std::vector<int> all_but(std::size_t count, const std::vector<int>& indices) {
  std::vector<bool> gone(count, false);
  for (const int i : indices) gone[static_cast<std::size_t>(i)] = true;
  std::vector<int> rest;
  for (std::size_t i = 0; i < count; ++i)
    if (!gone[i]) rest.push_back(static_cast<int>(i));
  return rest;
}

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread_of(const Points& points, const std::vector<int>& indices) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int i : indices) mean += points[static_cast<std::size_t>(i)].getVector3fMap().cast<double>();
  mean /= static_cast<double>(indices.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const int i : indices) {
    const Eigen::Vector3d away = points[static_cast<std::size_t>(i)].getVector3fMap().cast<double>() - mean;
    sum += away * away.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum / static_cast<double>(indices.size()));
}

/// Planes through the nearest neighbours of each point; the median distance of the nearest is the spacing.
double estimate_normals(const Points::Ptr& points, Normals& normals) {
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(points);
  std::vector<int> near;
  std::vector<float> squares;
  std::vector<double> nearest;
  for (std::size_t i = 0; i < points->size(); ++i) {
    tree.nearestKSearch(static_cast<int>(i), kNeighbours, near, squares);
    const Eigen::Vector3f normal = spread_of(*points, near).eigenvectors().col(0).cast<float>();
    normals.push_back(pcl::Normal(normal.x(), normal.y(), normal.z()));
    nearest.push_back(std::sqrt(static_cast<double>(squares.back()) / kNeighbours * std::acos(-1.0)));
  }
  return median(nearest);
}

/// A shape and the points that lie on it; no coefficients when there is none.
struct Found {
  Eigen::VectorXf coefficients;
  pcl::Indices on;
};

/// What pcl::SACSegmentation does with RANSAC, without its models of eighteen other shapes: drawn, then fitted.
Found find_shape(const pcl::SampleConsensusModel<pcl::PointXYZ>::Ptr& shape, double distance, int iterations) {
  pcl::RandomSampleConsensus<pcl::PointXYZ> consensus(shape, distance);
  consensus.setProbability(0.999);
  consensus.setMaxIterations(iterations);
  Found found;
  if (!consensus.computeModel()) return found;
  Eigen::VectorXf drawn;
  consensus.getModelCoefficients(drawn);
  consensus.getInliers(found.on);
  shape->optimizeModelCoefficients(found.on, drawn, found.coefficients);
  shape->selectWithinDistance(found.coefficients, distance, found.on);
  return found;
}

std::vector<int> plane_in(const Points::Ptr& points, double distance) {
  return find_shape(std::make_shared<pcl::SampleConsensusModelPlane<pcl::PointXYZ>>(points), distance, 2000).on;
}

std::vector<pcl::PointIndices> clusters_of(const Points::Ptr& points, double distance) {
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setInputCloud(points);
  extraction.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(false));
  extraction.setClusterTolerance(distance);
  extraction.setMinClusterSize(static_cast<int>(kFewest));
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  return clusters;
}

/// Of a plane's points those of pieces that hang together and are wide: the fronts of a row of pillars lie in one
/// plane, too, but each is a strip.
std::vector<int> wall_of(const Points& points, const std::vector<int>& plane, double spacing) {
  const Points::Ptr flat = chosen(points, plane);
  std::vector<int> wall;
  if (flat->size() < kFewest) return wall;
  for (const pcl::PointIndices& piece : clusters_of(flat, kClusterDistance * spacing)) {
    const Eigen::Vector3d spread = spread_of(*flat, piece.indices).eigenvalues();
    if (!(spread[1] > kPlaneWidth * kPlaneWidth * spread[2])) continue;
    for (const int i : piece.indices) wall.push_back(plane[static_cast<std::size_t>(i)]);
  }
  return wall;
}

/// A cylinder and the points that lie on it.
struct Cylinder {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double radius = 0.0;
  std::vector<int> on;

  [[nodiscard]] double distance(const Eigen::Vector3d& place) const { return axis.cross(place - point).norm(); }
};

Cylinder cylinder_in(const Points::Ptr& points, const Normals::Ptr& normals, double spacing) {
  const auto shape = std::make_shared<pcl::SampleConsensusModelCylinder<pcl::PointXYZ, pcl::Normal>>(points);
  Eigen::Vector4f low, high;
  pcl::getMinMax3D(*points, low, high);
  const double size = static_cast<double>((high - low).head<3>().norm());
  shape->setInputNormals(normals);
  shape->setNormalDistanceWeight(0.05);
  shape->setRadiusLimits(spacing, 0.5 * size);
  Found found = find_shape(shape, kCylinderDistance * spacing, 3000);
  Cylinder cylinder;
  if (found.coefficients.size() != 7 || found.on.size() < kFewest) return cylinder;
  const Eigen::VectorXd value = found.coefficients.cast<double>();
  cylinder.point = value.head<3>();
  cylinder.axis = value.segment<3>(3).normalized();
  cylinder.radius = std::abs(value[6]);
  cylinder.on = std::move(found.on);
  return cylinder;
}

Eigen::Vector3d place_of(const Points& points, int i) {
  return points[static_cast<std::size_t>(i)].getVector3fMap().cast<double>();
}

Pillar pillar_of(const Points& points, const Cylinder& cylinder) {
  std::vector<double> along;
  for (const int i : cylinder.on) along.push_back((place_of(points, i) - cylinder.point).dot(cylinder.axis));
  std::sort(along.begin(), along.end());
  const std::size_t few = along.size() / 100;
  Pillar pillar;
  pillar.from_m = cylinder.point + along[few] * cylinder.axis;
  pillar.to_m = cylinder.point + along[along.size() - 1 - few] * cylinder.axis;
  pillar.radius_m = cylinder.radius;
  return pillar;
}

/// What belongs to a pillar: its points, and all that lies within it, such as what noise has thrown off it. Bases and
/// capitals stick out by less than half of the radius.
std::vector<int> within(const Points& points, const Cylinder& cylinder, double spacing) {
  std::vector<int> inside;
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    if (cylinder.distance(place_of(points, i)) < kOwnRadius * cylinder.radius + spacing) inside.push_back(i);
  return inside;
}

bool is_one(const Pillar& a, const Pillar& b) {
  const double thicker = std::max(a.radius_m, b.radius_m);
  if (std::min(a.radius_m, b.radius_m) < kAlikeRadius * thicker) return false;
  const bool a_longer = (a.to_m - a.from_m).norm() > (b.to_m - b.from_m).norm();
  const Pillar& longer = a_longer ? a : b;
  const Pillar& other = a_longer ? b : a;
  const Eigen::Vector3d axis = (longer.to_m - longer.from_m).normalized();
  return std::max(axis.cross(other.from_m - longer.from_m).norm(), axis.cross(other.to_m - longer.from_m).norm()) <
         thicker;
}

/// Pieces of one pillar that something hides the middle of become one.
std::vector<Pillar> joined(std::vector<Pillar> pieces) {
  std::vector<Pillar> pillars;
  std::sort(pieces.begin(), pieces.end(), [](const Pillar& a, const Pillar& b) {
    return (a.to_m - a.from_m).squaredNorm() > (b.to_m - b.from_m).squaredNorm();
  });
  for (const Pillar& piece : pieces) {
    const auto whole =
        std::find_if(pillars.begin(), pillars.end(), [&](const Pillar& pillar) { return is_one(pillar, piece); });
    if (whole == pillars.end()) {
      pillars.push_back(piece);
      continue;
    }
    const Eigen::Vector3d axis = (whole->to_m - whole->from_m).normalized();
    for (const Eigen::Vector3d& end : {piece.from_m, piece.to_m}) {
      const double along = (end - whole->from_m).dot(axis);
      if (along < 0.0) whole->from_m += along * axis;
      if (along > (whole->to_m - whole->from_m).dot(axis)) whole->to_m = whole->from_m + along * axis;
    }
  }
  return pillars;
}

}  // namespace

std::vector<Pillar> find_pillars(const std::vector<Eigen::Vector3d>& points_m, Progress& progress) {
  std::vector<Pillar> pillars;
  if (points_m.size() < 100) return pillars;
  const QuietPcl quiet;
  const Eigen::Vector3d& origin_m = points_m.front();
  auto points = std::make_shared<Points>();
  for (const Eigen::Vector3d& p : points_m) {
    const Eigen::Vector3f local = (p - origin_m).cast<float>();
    points->push_back(pcl::PointXYZ(local.x(), local.y(), local.z()));
  }
  auto normals = std::make_shared<Normals>();
  const double spacing = estimate_normals(points, *normals);
  if (!(spacing > 0.0)) return pillars;
  const std::size_t all = points->size();
  for (int k = 0; k < kMostPlanes && points->size() >= kFewest; ++k) {
    progress.throw_if_cancelled();
    const std::vector<int> plane = plane_in(points, kPlaneDistance * spacing);
    const std::vector<int> wall = wall_of(*points, plane, spacing);
    if (static_cast<double>(wall.size()) < kPlaneShare * static_cast<double>(all)) break;
    const std::vector<int> rest = all_but(points->size(), wall);
    points = chosen(*points, rest);
    normals = chosen(*normals, rest);
  }
  if (points->size() < kFewest) return pillars;
  std::size_t looked_at = 0;
  for (const pcl::PointIndices& cluster : clusters_of(points, kClusterDistance * spacing)) {
    progress.at(static_cast<double>(looked_at) / static_cast<double>(points->size()));
    looked_at += cluster.indices.size();
    Points::Ptr part = chosen(*points, cluster.indices);
    Normals::Ptr part_normals = chosen(*normals, cluster.indices);
    for (int k = 0; k < kMostPillars && part->size() >= kFewest; ++k) {
      progress.throw_if_cancelled();
      const Cylinder cylinder = cylinder_in(part, part_normals, spacing);
      if (static_cast<double>(cylinder.on.size()) <
          std::max(kFewest * 1.0, kOwnShare * static_cast<double>(part->size())))
        break;
      Pillar pillar = pillar_of(*part, cylinder);
      if ((pillar.to_m - pillar.from_m).norm() < kSlender * pillar.radius_m) break;
      pillar.from_m += origin_m;
      pillar.to_m += origin_m;
      pillars.push_back(pillar);
      const std::vector<int> rest = all_but(part->size(), within(*part, cylinder, spacing));
      part = chosen(*part, rest);
      part_normals = chosen(*part_normals, rest);
    }
  }
  return joined(std::move(pillars));
}

}  // namespace sparsha::pipeline
