// Triangles of a surface are small against it, and share their corners to the last digit.
#include "pipeline/scan/formats/text/triangle_rows.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {

std::string TriangleRows::doubt() const {
  constexpr std::size_t kFewest = 16;
  constexpr double kSmall = 0.25;   // of the extent of all
  constexpr double kShared = 0.25;  // of the second corners are some triangle's first; of a closed surface nearly all
  using Corner = std::array<double, 3>;
  if (rows_.size() < kFewest) return {};
  const auto corner = [](const Row& row, std::size_t k) { return Corner{row[3 * k], row[3 * k + 1], row[3 * k + 2]}; };
  Row low = rows_[0];
  Row high = rows_[0];
  std::vector<double> sizes;
  std::set<Corner> firsts;
  for (const Row& row : rows_) {
    double size = 0.0;
    for (std::size_t k = 0; k < 9; ++k) {
      if (!std::isfinite(row[k])) return {};
      low[k] = std::min(low[k], row[k]);
      high[k] = std::max(high[k], row[k]);
      size = std::max(size, std::abs(row[k] - row[k % 3]));
    }
    sizes.push_back(size);
    firsts.insert(corner(row, 0));
  }
  double extent = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) extent = std::max(extent, high[axis] - low[axis]);
  const auto shared =
      std::count_if(rows_.begin(), rows_.end(), [&](const Row& row) { return firsts.contains(corner(row, 1)); });
  const double usual = quantile(sizes, 0.5);
  if (!(usual > 0.0) || usual > kSmall * extent ||
      static_cast<double>(shared) < kShared * static_cast<double>(rows_.size())) {
    return {};
  }
  return "the nine numbers of a row are the corners of a triangle, of which the first alone is read; save the mesh as "
         "STL, PLY or OBJ";
}

}  // namespace sparsha::pipeline
