// PCL's moving least squares, as its users smooth a cloud before they raster it.
#pragma once

#include <array>
#include <vector>

#include "pipeline/scan/cloud.h"

namespace sparsha::bench {

/// Points of pcl::MovingLeastSquares of order 2, relative to the cloud's origin; one thread, no upsampling.
[[nodiscard]] std::vector<std::array<double, 3>> by_pcl_mls(const pipeline::Cloud& cloud, double radius_m);

}  // namespace sparsha::bench
