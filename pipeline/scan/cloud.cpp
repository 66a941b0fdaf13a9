// The one place where Cloud meets PCL's point type.
#include "pipeline/scan/cloud.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

namespace sparsha::pipeline {

static_assert(sizeof(pcl::PointXYZ) == 4 * sizeof(float), "xyz1() shows PointXYZ as four floats");

Cloud::Cloud() : points(std::make_shared<pcl::PointCloud<pcl::PointXYZ>>()) {}

std::size_t Cloud::size() const { return points->size(); }

const float* Cloud::xyz1() const { return reinterpret_cast<const float*>(points->points.data()); }

float* Cloud::xyz1() { return reinterpret_cast<float*>(points->points.data()); }

void Cloud::resize_points(std::size_t count) {
  points->resize(count);
  points->width = static_cast<std::uint32_t>(count);
  points->height = 1;
  points->is_dense = true;
}

}  // namespace sparsha::pipeline
