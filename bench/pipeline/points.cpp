// PCL stays here.
#include "bench/pipeline/points.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>

namespace sparsha::bench {

std::vector<std::array<float, 3>> points_of(const pipeline::Cloud& cloud) {
  std::vector<std::array<float, 3>> points;
  points.reserve(cloud.size());
  for (const pcl::PointXYZ& p : *cloud.points) points.push_back({p.x, p.y, p.z});
  return points;
}

double agreement_percent(const pipeline::Cloud& original, const pipeline::Cloud& a, const pipeline::Cloud& b) {
  const auto all = points_of(original), kept_a = points_of(a), kept_b = points_of(b);
  std::size_t at_a = 0, at_b = 0, alike = 0;
  for (const auto& point : all) {
    const bool in_a = at_a < kept_a.size() && kept_a[at_a] == point;
    const bool in_b = at_b < kept_b.size() && kept_b[at_b] == point;
    at_a += in_a ? 1 : 0;
    at_b += in_b ? 1 : 0;
    alike += in_a == in_b ? 1 : 0;
  }
  return all.empty() ? 100.0 : 100.0 * static_cast<double>(alike) / static_cast<double>(all.size());
}

}  // namespace sparsha::bench
