// The filter behind the template, and the template for the common point types.
#include <cmath>

#include <pcl/point_types.h>

#include "base/error.h"
#include "base/threads/context.h"
#include "pipeline/filter/outliers.h"
#include "sparsha/pcl/impl/statistical_outlier_filter.hpp"

namespace sparsha {
namespace detail {

std::vector<std::uint8_t> statistical_inliers(const pipeline::Cloud& cloud, int neighbours, double deviations,
                                              unsigned threads) {
  if (neighbours < 1) throw usage_error("an outlier filter with fewer than one neighbour", "MeanK of 1 or more");
  if (!std::isfinite(deviations)) throw usage_error("a threshold that is no number", "a finite StddevMulThresh");
  ThreadPool pool(threads);
  Progress progress;
  return pipeline::statistical_inliers(cloud, {neighbours, deviations}, {pool, progress});
}

}  // namespace detail

template class StatisticalOutlierFilter<::pcl::PointXYZ>;
template class StatisticalOutlierFilter<::pcl::PointXYZI>;
template class StatisticalOutlierFilter<::pcl::PointXYZRGB>;
template class StatisticalOutlierFilter<::pcl::PointXYZRGBA>;
template class StatisticalOutlierFilter<::pcl::PointNormal>;
template class StatisticalOutlierFilter<::pcl::PointXYZRGBNormal>;

}  // namespace sparsha
