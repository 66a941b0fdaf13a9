// Hands a PCL cloud's coordinates to the projection as plain floats.
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pipeline/projection/points.h"

namespace sparsha::pipeline {

RawPoints raw_points(const Cloud& cloud) {
  if (!cloud.points || cloud.points->empty()) return {};
  static_assert(sizeof(pcl::PointXYZ) % sizeof(float) == 0);
  return {cloud.points->front().data, sizeof(pcl::PointXYZ) / sizeof(float), cloud.points->size()};
}

}  // namespace sparsha::pipeline
