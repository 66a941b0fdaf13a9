// Connected cells of a lattice in space, and again within the group that was found.
#include "pipeline/suggest/group.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

namespace sparsha::pipeline {
namespace {

constexpr double kCells = 64.0;    // along the longest side
constexpr double kSmall = 0.05;    // of that side: a group that a grid over all would not show
constexpr double kOthers = 0.001;  // of the points
constexpr double kMargin = 0.05;   // of a group's longest side
constexpr double kLeast = 0.3;     // of the points: many objects apart are a scene, not one object and strays
constexpr int kDeepest = 4;

using Cell = std::array<std::int64_t, 3>;

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  std::size_t points = 0;

  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
    points += other.points;
  }
  [[nodiscard]] double longest() const { return (high - low).maxCoeff(); }
};

// Takes the cell and all that are connected with it.
Box take_group(std::map<Cell, Box>& cells, std::map<Cell, Box>::iterator first) {
  Box group = first->second;
  std::vector<Cell> open{first->first};
  cells.erase(first);
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto found = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (found == cells.end()) continue;
      group.add(found->second);
      open.push_back(found->first);
      cells.erase(found);
    }
  }
  return group;
}

// The largest group of those points, connected by cells of that width.
Box largest_group(const std::vector<Eigen::Vector3d>& points_m, const Box& all, double cell_m) {
  std::map<Cell, Box> cells;
  for (const Eigen::Vector3d& p : points_m) {
    const Eigen::Vector3d place = ((p - all.low) / cell_m).array().floor();
    cells[{static_cast<std::int64_t>(place.x()), static_cast<std::int64_t>(place.y()),
           static_cast<std::int64_t>(place.z())}]
        .add({p, p, 1});
  }
  Box largest;
  while (!cells.empty()) {
    const Box group = take_group(cells, cells.begin());
    if (group.points > largest.points) largest = group;
  }
  return largest;
}

// With a margin.
PointGroup group_of(const Box& box, double all) {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kMargin * box.longest());
  PointGroup group;
  group.crop.min_m = ((box.low - margin) * 1e3).array().floor() / 1e3 + 0.0;
  group.crop.max_m = ((box.high + margin) * 1e3).array().ceil() / 1e3 + 0.0;
  group.share = static_cast<double>(box.points) / all;
  return group;
}

}  // namespace

PointGroup largest_piece(const std::vector<Eigen::Vector3d>& points_m, double apart_m) {
  Box box;
  for (const Eigen::Vector3d& p : points_m) box.add({p, p, 1});
  return group_of(largest_group(points_m, box, apart_m), static_cast<double>(points_m.size()));
}

std::optional<PointGroup> main_group(const std::vector<Eigen::Vector3d>& points_m) {
  constexpr double kFar_m = 1e9;
  std::vector<Eigen::Vector3d> points = points_m;
  std::erase_if(points, [](const Eigen::Vector3d& p) { return !(p.cwiseAbs().maxCoeff() < kFar_m); });
  const auto all = static_cast<double>(points.size());
  std::optional<PointGroup> found;
  for (int depth = 0; depth < kDeepest; ++depth) {
    Box box;
    for (const Eigen::Vector3d& p : points) box.add({p, p, 1});
    if (!(box.longest() > 0.0)) break;
    const Box group = largest_group(points, box, box.longest() / kCells);
    const double elsewhere = static_cast<double>(points.size() - group.points);
    if (!(group.longest() > 0.0 && group.longest() < kSmall * box.longest()) || elsewhere < kOthers * all ||
        static_cast<double>(group.points) < kLeast * all) {
      break;
    }
    const PointGroup result = group_of(group, all);
    found = result;
    std::erase_if(points, [&](const Eigen::Vector3d& p) {
      return (p.array() < result.crop.min_m.array()).any() || (p.array() > result.crop.max_m.array()).any();
    });
  }
  return found;
}

}  // namespace sparsha::pipeline
