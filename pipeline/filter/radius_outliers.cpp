// Neighbours are counted cell by cell, and only until there are enough.
#include <algorithm>

#include "pipeline/filter/cells.h"
#include "pipeline/filter/outliers.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kCellsATime = 4096;

/// True when at least `most` points but `point` itself are within `reach` (squared) of it.
bool has_neighbours(const CellOrder& order, const CellOrder::Point& point,
                    const std::array<CellOrder::Range, 25>& ranges, double reach, std::size_t most) {
  std::size_t found = 0;
  for (const CellOrder::Range& range : ranges) {
    for (const CellOrder::Point& other : order.points(range)) {
      if (other.index == point.index) continue;
      if (static_cast<double>(squared_distance(point, other)) <= reach && ++found >= most) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> radius_inliers(const Cloud& cloud, const scene::RadiusOutlierConfig& config,
                                         const Context& context) {
  std::vector<std::uint8_t> keep(cloud.size(), 1);
  const auto most = static_cast<std::size_t>(config.neighbours);
  const double reach = config.radius_m * config.radius_m;
  const CellOrder order(cloud, config.radius_m, context);
  context.pool.for_ranges(order.cells(), kCellsATime, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    CellOrder::Sweep sweep(order);
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto points = order.points(cell);
      if (points.size() > most) continue;  // all are within reach of each other
      const auto& near = sweep.near(cell);
      for (const CellOrder::Point& p : points) keep[p.index] = has_neighbours(order, p, near, reach, most) ? 1 : 0;
    }
  });
  return keep;
}

}  // namespace sparsha::pipeline
