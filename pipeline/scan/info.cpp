// What `sparsha info` and `sparsha new` say of a scan without building it.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pipeline/scan/origin.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/units.h"

namespace sparsha::pipeline {
namespace {

/// Valid points less the number of different ones.
std::uint64_t count_duplicates(const std::vector<Eigen::Vector3d>& points) {
  std::vector<std::array<double, 3>> sorted;
  sorted.reserve(points.size());
  for (const Eigen::Vector3d& p : points) sorted.push_back({p.x(), p.y(), p.z()});
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t count = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i] == sorted[i - 1] ? 1 : 0;
  return count;
}

/// Median distance of sampled points to the nearest one that is not at the same place; 0 without any.
double median_spacing(const std::vector<Eigen::Vector3d>& points) {
  constexpr std::size_t kQueries = 2000;
  constexpr std::size_t kMostNeighbours = 64;
  if (points.size() < 2) return 0.0;
  PointSample sample;
  for (const Eigen::Vector3d& p : points) sample.add(p);
  const std::vector<Eigen::Vector3d> some = sample.points();
  const Eigen::Vector3d centre(quantile(some, 0, 0.5), quantile(some, 1, 0.5), quantile(some, 2, 0.5));
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3f q = (p - centre).cast<float>();
    if (q.allFinite() && q.squaredNorm() < 1e30F) cloud->push_back({q.x(), q.y(), q.z()});
  }
  if (cloud->size() < 2) return 0.0;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setSortedResults(true);
  tree.setInputCloud(cloud);
  std::vector<float> distances;
  pcl::Indices found;
  std::vector<float> squared;
  const std::size_t step = std::max<std::size_t>(1, cloud->size() / kQueries);
  for (std::size_t i = 0; i < cloud->size(); i += step) {
    for (std::size_t k = 2;; k *= 4) {
      k = std::min({k, kMostNeighbours, cloud->size()});
      tree.nearestKSearch((*cloud)[i], static_cast<int>(k), found, squared);
      const auto other = std::find_if(squared.begin(), squared.end(), [](float d) { return d > 0.0F; });
      if (other != squared.end()) {
        distances.push_back(std::sqrt(*other));
        break;
      }
      if (k == kMostNeighbours || k == cloud->size()) break;
    }
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return static_cast<double>(*middle);
}

}  // namespace

ScanInfo inspect_scan(const std::filesystem::path& file) {
  const RawScan scan = read_scan(file);
  ScanInfo info;
  info.format = scan.format;
  info.points = scan.records;
  info.invalid = scan.invalid;
  info.fields = scan.fields;
  info.units = scan.degrees ? "degrees" : scan.unit ? to_string(*scan.unit) : "unknown";
  info.scans = scan.scans;
  info.viewpoint = scan.viewpoint;
  info.warnings = scan.warnings;
  const double scale = metres_in(scan.unit.value_or(LengthUnit::automatic));
  if (scan.points.empty()) return info;
  Eigen::Vector3d low = scan.points.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& p : scan.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  info.min_m = low * scale;
  info.max_m = high * scale;
  info.duplicates = count_duplicates(scan.points);
  info.spacing_m = median_spacing(scan.points) * scale;
  if (const std::optional<UnitGuess> guess = guess_unit(scan)) info.warnings.push_back("unit: " + guess->reason);
  return info;
}

}  // namespace sparsha::pipeline
