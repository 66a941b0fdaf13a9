// The ranks of coordinates in an even sample decide which points are strays; all other points count.
#include "viewer/cloud/bounds.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/numbers/statistics.h"

namespace sparsha::viewer {

Bounds bounds_of(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kSample = 40000;
  constexpr double kRank = 0.005;
  constexpr float kBeyond = 0.25F;
  const std::size_t step = std::max<std::size_t>(points.size() / kSample, 1);
  Bounds near;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (std::size_t n = 0; n < points.size(); n += step) values.push_back(points[n][axis]);
    const float first = quantile(values, kRank), last = quantile(values, 1.0 - kRank);
    near.low[axis] = first - kBeyond * (last - first);
    near.high[axis] = last + kBeyond * (last - first);
  }
  Bounds bounds{near.high, near.low};
  for (const Eigen::Vector3f& p : points) {
    if (!near.contains(p)) continue;
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return (bounds.low.array() <= bounds.high.array()).all() ? bounds : near;
}

}  // namespace sparsha::viewer
