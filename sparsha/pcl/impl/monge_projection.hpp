// What monge_projection.h declares, for any point type with x, y and z.
#pragma once

#include <pcl/impl/pcl_base.hpp>

#include "base/error.h"
#include "sparsha/pcl/impl/conversions.hpp"
#include "sparsha/pcl/monge_projection.h"

namespace sparsha {
namespace detail {

struct MongeSettings {
  Eigen::Matrix4d scan_to_grid;
  double spacing_m;
  int size;
  const std::vector<double>& bounds_m;
  double noise_m;
  unsigned threads;
};
struct MongeResult {
  scene::DepthGrid grid;
  double noise_m = 0.0;
  double point_spacing_m = 0.0;
  std::vector<ProjectedPoint> points;  ///< one per point of the cloud
};
[[nodiscard]] MongeResult project(const pipeline::Cloud& cloud, const MongeSettings& settings);

}  // namespace detail

template <typename PointT>
void MongeProjection<PointT>::compute(scene::DepthGrid& output) {
  if (!this->input_) throw Error(ErrorKind::input, {}, "a projection without a cloud", "setInputCloud before compute");
  ::pcl::Indices kept;
  const pipeline::Cloud cloud = this->use_indices_ && this->indices_ && !this->fake_indices_
                                    ? to_cloud(*this->input_, *this->indices_, origin_m_, &kept)
                                    : to_cloud(*this->input_, origin_m_, &kept);
  detail::MongeResult result =
      detail::project(cloud, {orientation_.matrix(), spacing_m_, size_, bounds_m_, noise_m_, threads_});
  points_.assign(this->input_->size(), ProjectedPoint::invalid);
  for (std::size_t i = 0; i < kept.size(); ++i) points_[static_cast<std::size_t>(kept[i])] = result.points[i];
  found_noise_m_ = result.noise_m;
  point_spacing_m_ = result.point_spacing_m;
  output = std::move(result.grid);
}

}  // namespace sparsha
