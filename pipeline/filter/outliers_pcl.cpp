// The outlier filters that PCL has.
#include <algorithm>

#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include "pipeline/filter/cancellable_tree.h"
#include "pipeline/filter/outliers.h"
#include "pipeline/scan/pcl_trees.hpp"

namespace sparsha::pipeline {
namespace {

std::vector<std::uint8_t> flags(const pcl::Indices& inliers, std::size_t count) {
  std::vector<std::uint8_t> keep(count, 0);
  for (const pcl::index_t i : inliers) keep[static_cast<std::size_t>(i)] = 1;
  return keep;
}

using SearchPtr = pcl::search::Search<pcl::PointXYZ>::Ptr;
using Statistical = pcl::StatisticalOutlierRemoval<pcl::PointXYZ>;
using Radius = pcl::RadiusOutlierRemoval<pcl::PointXYZ>;

// PCL 1.13 lets nobody choose the tree of these two, which it makes when there is none. An explicit instantiation may
// name a private member.
SearchPtr& search_of(Statistical& filter);
SearchPtr& search_of(Radius& filter);
template <typename Filter, SearchPtr Filter::*kSearch>
struct SearchAccess {
  friend SearchPtr& search_of(Filter& filter) { return filter.*kSearch; }
};
template struct SearchAccess<Statistical, &Statistical::searcher_>;
template struct SearchAccess<Radius, &Radius::searcher_>;

}  // namespace

std::vector<std::uint8_t> statistical_inliers_by_pcl(const Cloud& cloud, const scene::OutlierConfig& config,
                                                     const Progress& progress) {
  std::vector<std::uint8_t> keep(cloud.size(), 1);
  if (cloud.size() < 2) return keep;
  Statistical filter;
  search_of(filter) = cancellable_tree(progress);
  filter.setInputCloud(cloud.points);
  // PCL reads past its arrays when it is asked for more neighbours than there are.
  filter.setMeanK(std::min(config.neighbours, static_cast<int>(cloud.size()) - 1));
  filter.setStddevMulThresh(config.sigma);
  pcl::Indices inliers;
  filter.filter(inliers);
  return flags(inliers, cloud.size());
}

std::vector<std::uint8_t> radius_inliers_by_pcl(const Cloud& cloud, const scene::RadiusOutlierConfig& config,
                                                const Progress& progress) {
  if (cloud.size() == 0) return {};
  Radius filter;
  search_of(filter) = cancellable_tree(progress);
  filter.setInputCloud(cloud.points);
  filter.setRadiusSearch(config.radius_m);
  filter.setMinNeighborsInRadius(config.neighbours);
  pcl::Indices inliers;
  filter.filter(inliers);
  return flags(inliers, cloud.size());
}

}  // namespace sparsha::pipeline
