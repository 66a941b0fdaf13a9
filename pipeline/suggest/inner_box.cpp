// Order statistics of each axis.
#include "pipeline/suggest/inner_box.h"

#include <algorithm>
#include <cmath>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {

InnerBox inner_box(const std::vector<Eigen::Vector3d>& points_m) {
  InnerBox box;
  std::vector<double> values(points_m.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points_m.begin(), points_m.end(), values.begin(), [axis](const auto& p) { return p[axis]; });
    const auto at = [&](double share) {
      const double place = share * static_cast<double>(values.size() - 1);
      return value_of_rank(values, static_cast<std::size_t>(share < 0.5 ? std::floor(place) : std::ceil(place)));
    };
    box.low[axis] = at(0.01);
    box.high[axis] = at(0.99);
  }
  return box;
}

}  // namespace sparsha::pipeline
