// Clouds between PCL's point types and Sparsha's.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/types.h>
#include <Eigen/Core>

#include "pipeline/scan/cloud.h"

namespace sparsha {

/// The finite points of `points`, in their order; those that are not are counted in `invalid`. Colour, intensity and
/// normals come along where PointT has them. A sensor_origin_ that is not zero becomes a station, and surfaces then
/// face it; normals tell which side is outside, unless they contradict what is seen. `origin_m` is what was subtracted
/// from the coordinates before they became float32, metres. `kept`, when given, gets the index of each point.
/// Instantiated for PointXYZ, PointXYZI, PointXYZRGB, PointXYZRGBA, PointNormal and PointXYZRGBNormal; for other types
/// include impl/conversions.hpp.
template <typename PointT>
[[nodiscard]] pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>& points,
                                       const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero(),
                                       ::pcl::Indices* kept = nullptr);

/// The same of the points with these indices. Throws Error{input} on an index that the cloud does not have.
template <typename PointT>
[[nodiscard]] pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>& points, const ::pcl::Indices& indices,
                                       const Eigen::Vector3d& origin_m = Eigen::Vector3d::Zero(),
                                       ::pcl::Indices* kept = nullptr);

/// The points of `cloud`, metres relative to cloud.origin_m. Fields that the cloud has nothing for keep PointT's
/// defaults. The first station of the cloud becomes sensor_origin_.
template <typename PointT>
void from_cloud(const pipeline::Cloud& cloud, ::pcl::PointCloud<PointT>& points);

}  // namespace sparsha
