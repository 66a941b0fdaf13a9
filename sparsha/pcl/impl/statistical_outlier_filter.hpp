// What statistical_outlier_filter.h declares, for any point type with x, y and z.
#pragma once

#include <cstdint>
#include <vector>

#include <pcl/filters/impl/filter.hpp>
#include <pcl/filters/impl/filter_indices.hpp>
#include <pcl/impl/pcl_base.hpp>

#include "sparsha/pcl/impl/conversions.hpp"
#include "sparsha/pcl/statistical_outlier_filter.h"

namespace sparsha {
namespace detail {

/// keep[i] = 1 for points that are no outliers.
[[nodiscard]] std::vector<std::uint8_t> statistical_inliers(const pipeline::Cloud& cloud, int neighbours,
                                                            double deviations, unsigned threads);

}  // namespace detail

template <typename PointT>
void StatisticalOutlierFilter<PointT>::applyFilter(::pcl::Indices& indices) {
  ::pcl::Indices finite;
  const pipeline::Cloud cloud = to_cloud(*this->input_, *this->indices_, Eigen::Vector3d::Zero(), &finite);
  const std::vector<std::uint8_t> keep = detail::statistical_inliers(cloud, mean_k_, deviations_, threads_);
  indices.clear();
  this->removed_indices_->clear();
  std::size_t next = 0;
  for (const ::pcl::index_t index : *this->indices_) {
    const bool is_finite = next < finite.size() && finite[next] == index;
    const bool stays = is_finite && (keep[next] != 0) != this->negative_;
    if (is_finite) ++next;
    if (stays)
      indices.push_back(index);
    else if (this->extract_removed_indices_)
      this->removed_indices_->push_back(index);
  }
}

}  // namespace sparsha
