// Local planes from PCL's kd-tree: mean, covariance, smallest eigenvector.
#include "pipeline/register/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Eigenvalues>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "base/numbers/statistics.h"
#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {
namespace {

constexpr int kNeighbours = 16;         // of a local plane, the point included
constexpr double kLeastFlatness = 3.0;  // second over third standard deviation of what is called a surface
constexpr double kLongestShape = 6.0;   // first over second: beyond, a line
constexpr double kReach = 6.0;          // spacings within which neighbours belong to a surface
constexpr double kBorder = 0.45;        // offset of the neighbours' mean over their mean distance, at a border
constexpr std::size_t kGrain = 1024;
constexpr std::size_t kAsked = 2000;  // points whose nearest neighbour tells the spacing

struct PointTree {
  pcl::KdTreeFLANN<pcl::PointXYZ> search;

  int find(const Eigen::Vector3d& point, int count, pcl::Indices& indices, std::vector<float>& distances2) const {
    const Eigen::Vector3f p = point.cast<float>();
    return search.nearestKSearch(pcl::PointXYZ(p.x(), p.y(), p.z()), static_cast<unsigned>(count), indices, distances2);
  }

  void fill(const std::vector<Eigen::Vector3d>& points) {
    auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    cloud->reserve(points.size());
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3f p = point.cast<float>();
      cloud->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
    }
    search.setInputCloud(cloud);
  }

  // Of some of the points that it is filled with.
  [[nodiscard]] std::vector<double> nearest(const std::vector<Eigen::Vector3d>& points) const {
    const std::size_t step = std::max<std::size_t>(1, points.size() / kAsked);
    std::vector<double> distances;
    pcl::Indices indices;
    std::vector<float> distances2;
    for (std::size_t i = 0; i < points.size(); i += step)
      if (find(points[i], 2, indices, distances2) == 2)
        distances.push_back(std::sqrt(static_cast<double>(distances2[1])));
    return distances;
  }
};

}  // namespace

struct StationSurface::Tree : PointTree {};

std::vector<double> nearest_distances(const std::vector<Eigen::Vector3d>& points) {
  if (points.empty()) return {};
  PointTree tree;
  tree.fill(points);
  return tree.nearest(points);
}

StationSurface::StationSurface(std::vector<Eigen::Vector3d> points, const std::optional<Eigen::Vector3d>& place,
                               const Context& context)
    : tree_(std::make_unique<Tree>()), signed_(place.has_value()) {
  elements_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) elements_[i].point = points[i];
  if (elements_.empty()) return;
  tree_->fill(points);
  std::vector<double> nearest = tree_->nearest(points);
  if (!nearest.empty()) spacing_m_ = median(nearest);
  std::vector<double> across(elements_.size());
  context.pool.for_ranges(elements_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t i = begin; i < end; ++i) across[i] = fit(i, place).value_or(-1.0);
  });
  std::erase_if(across, [](double deviation_m) { return deviation_m < 0.0; });
  if (!across.empty()) roughness_m_ = median(across);
}

StationSurface::~StationSurface() = default;

std::optional<double> StationSurface::fit(std::size_t index, const std::optional<Eigen::Vector3d>& place) {
  Element& element = elements_[index];
  pcl::Indices indices;
  std::vector<float> distances2;
  const int found = tree_->find(element.point, kNeighbours, indices, distances2);
  const double reach2 = kReach * kReach * spacing_m_ * spacing_m_;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double distance = 0.0;
  int used = 0;
  while (used < found && static_cast<double>(distances2[static_cast<std::size_t>(used)]) <= reach2) {
    mean += elements_[static_cast<std::size_t>(indices[static_cast<std::size_t>(used)])].point - element.point;
    distance += std::sqrt(static_cast<double>(distances2[static_cast<std::size_t>(used)]));
    ++used;
  }
  if (used < kNeighbours / 2) return std::nullopt;
  mean /= used;
  distance /= used;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int k = 0; k < used; ++k) {
    const Eigen::Vector3d offset =
        elements_[static_cast<std::size_t>(indices[static_cast<std::size_t>(k)])].point - element.point - mean;
    covariance += offset * offset.transpose();
  }
  covariance /= used;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d deviation = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (!(deviation[1] > kLeastFlatness * deviation[0]) || deviation[2] > kLongestShape * deviation[1])
    return std::nullopt;
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (place && normal.dot(*place - element.point) < 0.0) normal = -normal;
  element.normal = normal;
  const Eigen::Vector3d aside = mean - normal * normal.dot(mean);
  element.border = aside.norm() > kBorder * distance;
  return deviation[0];
}

void StationSurface::flip() {
  for (Element& element : elements_) element.normal = -element.normal;
}

StationSurface::Nearest StationSurface::nearest(const Eigen::Vector3d& point, double within_m) const {
  thread_local pcl::Indices indices;
  thread_local std::vector<float> distances2;
  // Bounded: a search without a limit visits most of the tree when the point is far away.
  const Eigen::Vector3f p = point.cast<float>();
  if (tree_->search.radiusSearch(pcl::PointXYZ(p.x(), p.y(), p.z()), within_m, indices, distances2, 1) < 1)
    return {elements_.size(), 0.0};
  const auto index = static_cast<std::size_t>(indices[0]);
  return {index, (elements_[index].point - point).squaredNorm()};
}

void VoxelMeans::add(const Eigen::Vector3d& point) {
  Cell cell;
  for (std::size_t k = 0; k < 3; ++k)
    cell[k] = static_cast<std::int64_t>(std::floor(point[static_cast<Eigen::Index>(k)] / leaf_m_));
  Sum& sum = sums_[cell];
  sum.sum += point;
  sum.count += 1.0;
}

std::vector<Eigen::Vector3d> VoxelMeans::points() const {
  std::vector<std::pair<Cell, const Sum*>> order;
  order.reserve(sums_.size());
  for (const auto& [cell, sum] : sums_) order.emplace_back(cell, &sum);
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Eigen::Vector3d> result;
  result.reserve(order.size());
  for (const auto& [cell, sum] : order) result.emplace_back(sum->sum / sum->count);
  return result;
}

std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points, double leaf_m) {
  VoxelMeans means(leaf_m);
  for (const Eigen::Vector3d& point : points) means.add(point);
  return means.points();
}

std::vector<Eigen::Vector3d> thinned_to(const std::vector<Eigen::Vector3d>& points, std::size_t most,
                                        double least_leaf_m) {
  if (points.size() <= most) return points;
  constexpr double kGrowth = 1.25;
  for (double leaf_m = least_leaf_m;; leaf_m *= kGrowth) {
    std::vector<Eigen::Vector3d> result = thinned(points, leaf_m);
    if (result.size() <= most) return result;
    // Points on a surface grow as the square of 1 / leaf; the last steps are small.
    leaf_m *= std::max(1.0, 0.8 * std::sqrt(static_cast<double>(result.size()) / static_cast<double>(most)));
  }
}

}  // namespace sparsha::pipeline
