// The outlier filters that PCL has.
#include <algorithm>

#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include "pipeline/filter/outliers.h"

namespace sparsha::pipeline {
namespace {

std::vector<std::uint8_t> flags(const pcl::Indices& inliers, std::size_t count) {
  std::vector<std::uint8_t> keep(count, 0);
  for (const pcl::index_t i : inliers) keep[static_cast<std::size_t>(i)] = 1;
  return keep;
}

}  // namespace

std::vector<std::uint8_t> statistical_inliers_by_pcl(const Cloud& cloud, const OutlierConfig& config) {
  std::vector<std::uint8_t> keep(cloud.size(), 1);
  if (cloud.size() < 2) return keep;
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud.points);
  // PCL reads past its arrays when it is asked for more neighbours than there are.
  filter.setMeanK(std::min(config.neighbours, static_cast<int>(cloud.size()) - 1));
  filter.setStddevMulThresh(config.sigma);
  pcl::Indices inliers;
  filter.filter(inliers);
  return flags(inliers, cloud.size());
}

std::vector<std::uint8_t> radius_inliers_by_pcl(const Cloud& cloud, const RadiusOutlierConfig& config) {
  if (cloud.size() == 0) return {};
  pcl::RadiusOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud.points);
  filter.setRadiusSearch(config.radius_m);
  filter.setMinNeighborsInRadius(config.neighbours);
  pcl::Indices inliers;
  filter.filter(inliers);
  return flags(inliers, cloud.size());
}

}  // namespace sparsha::pipeline
