// What conversions.h declares, for any point type with x, y and z.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <pcl/point_types.h>
#include <pcl/type_traits.h>

#include "base/error.h"
#include "sparsha/pcl/conversions.h"

namespace sparsha {
namespace detail {

/// Tells the outer sides by where the cloud's sensor stood, unless that is zero, which is what programs write that do
/// not know, and by its normals where there are some.
void add_stations(pipeline::Cloud& cloud, const Eigen::Vector4f& sensor_origin);

template <typename PointT, typename IndexAt>
pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>& points, std::size_t count, const IndexAt& index_at,
                         const Eigen::Vector3d& origin_m, ::pcl::Indices* kept) {
  pipeline::Cloud cloud;
  cloud.origin_m = origin_m;
  cloud.resize_points(count);
  if (kept != nullptr) kept->clear();
  float* out = cloud.xyz1();
  std::size_t valid = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const ::pcl::index_t index = index_at(i);
    if (index < 0 || static_cast<std::size_t>(index) >= points.size()) {
      throw Error(ErrorKind::input, {}, "an index of " + std::to_string(index),
                  "0 to " + std::to_string(points.size()) + ", without the last, as the cloud has points");
    }
    const PointT& p = points[static_cast<std::size_t>(index)];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      ++cloud.invalid;
      continue;
    }
    out[0] = p.x;
    out[1] = p.y;
    out[2] = p.z;
    out += 4;
    if constexpr (::pcl::traits::has_color<PointT>::value) {
      cloud.rgba.push_back(static_cast<std::uint32_t>(p.r) | static_cast<std::uint32_t>(p.g) << 8 |
                           static_cast<std::uint32_t>(p.b) << 16 | static_cast<std::uint32_t>(p.a) << 24);
    }
    if constexpr (::pcl::traits::has_intensity<PointT>::value) cloud.intensity.push_back(p.intensity);
    if constexpr (::pcl::traits::has_normal<PointT>::value) {
      cloud.normals.emplace_back(p.normal_x, p.normal_y, p.normal_z);
    }
    if (kept != nullptr) kept->push_back(index);
    ++valid;
  }
  cloud.resize_points(valid);
  add_stations(cloud, points.sensor_origin_);
  return cloud;
}

}  // namespace detail

template <typename PointT>
pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>& points, const Eigen::Vector3d& origin_m,
                         ::pcl::Indices* kept) {
  return detail::to_cloud(
      points, points.size(), [](std::size_t i) { return static_cast<::pcl::index_t>(i); }, origin_m, kept);
}

template <typename PointT>
pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>& points, const ::pcl::Indices& indices,
                         const Eigen::Vector3d& origin_m, ::pcl::Indices* kept) {
  return detail::to_cloud(
      points, indices.size(), [&](std::size_t i) { return indices[i]; }, origin_m, kept);
}

template <typename PointT>
void from_cloud(const pipeline::Cloud& cloud, ::pcl::PointCloud<PointT>& points) {
  points = ::pcl::PointCloud<PointT>();
  points.resize(cloud.size());
  points.width = static_cast<std::uint32_t>(cloud.size());
  points.height = 1;
  points.is_dense = true;
  const float* xyz = cloud.xyz1();
  for (std::size_t i = 0; i < cloud.size(); ++i, xyz += 4) {
    PointT& p = points[i];
    p.x = xyz[0];
    p.y = xyz[1];
    p.z = xyz[2];
    if constexpr (::pcl::traits::has_color<PointT>::value) {
      if (!cloud.rgba.empty()) {
        p.r = static_cast<std::uint8_t>(cloud.rgba[i]);
        p.g = static_cast<std::uint8_t>(cloud.rgba[i] >> 8);
        p.b = static_cast<std::uint8_t>(cloud.rgba[i] >> 16);
        p.a = static_cast<std::uint8_t>(cloud.rgba[i] >> 24);
      }
    }
    if constexpr (::pcl::traits::has_intensity<PointT>::value) {
      if (!cloud.intensity.empty()) p.intensity = cloud.intensity[i];
    }
    if constexpr (::pcl::traits::has_normal<PointT>::value) {
      if (!cloud.normals.empty()) {
        p.normal_x = cloud.normals[i].x();
        p.normal_y = cloud.normals[i].y();
        p.normal_z = cloud.normals[i].z();
      }
    }
  }
  for (const pipeline::Station& station : cloud.stations) {
    if (!station.normals.empty()) continue;
    points.sensor_origin_.template head<3>() = (station.place_m - cloud.origin_m).template cast<float>();
    break;
  }
}

}  // namespace sparsha
