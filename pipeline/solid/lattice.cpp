// A node tells the sides of both ends of the piece of a line that it lies on: no other layer is between.
#include "pipeline/solid/lattice.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace sparsha::pipeline {

SurfaceLattice::SurfaceLattice(const scene::Charts& charts) {
  nodes_.reserve(charts.measured_nodes());
  for (const scene::Sheet& sheet : charts.sheets) {
    for (int j = 0; j < sheet.ny; ++j) {
      for (int i = 0; i < sheet.nx; ++i) {
        if (sheet.measured(sheet.index(i, j))) add(charts, sheet, i, j);
      }
    }
  }
  judge();
}

void SurfaceLattice::add(const scene::Charts& charts, const scene::Sheet& sheet, int i, int j) {
  const scene::SideAxes axes = scene::SideAxes::of(sheet.side);
  const double along = axes.sign * static_cast<double>(sheet.height_m[sheet.index(i, j)]) / charts.spacing_m;
  const double low = std::floor(along);
  const std::array<double, 3> place{low, static_cast<double>(sheet.first_u) + i,
                                    static_cast<double>(sheet.first_v) + j};
  for (const double x : place) {
    if (!(std::abs(x) < kMost)) {
      throw usage_error("an object of more than " + std::to_string(2 * kMost) + " spacings has no closed mesh",
                        "a larger grid.spacing_mm");
    }
  }
  LatticePoint point{};
  point[static_cast<std::size_t>(axes.w)] = static_cast<std::int32_t>(place[0]);
  point[static_cast<std::size_t>(axes.u)] = static_cast<std::int32_t>(place[1]);
  point[static_cast<std::size_t>(axes.v)] = static_cast<std::int32_t>(place[2]);
  const auto facing = static_cast<float>(scene::Charts::normal(sheet, i, j)[axes.w]);
  const std::uint32_t at = number(point);
  nodes_.push_back({static_cast<float>(along - low), facing, table_[at].first[static_cast<std::size_t>(axes.w)]});
  table_[at].first[static_cast<std::size_t>(axes.w)] = static_cast<std::uint32_t>(nodes_.size() - 1);
  ++point[static_cast<std::size_t>(axes.w)];
  (void)number(point);
}

void SurfaceLattice::judge() {
  // Nodes that are near along the line count for more: at a sharp edge the others' planes go on beyond it.
  const auto weight_of = [](float along) { return 1.0F / (along * along + 0.05F); };
  std::vector<float> weights(points(), 0.0F);
  const auto vote = [&](std::uint32_t to, float along, float distance) {
    weights[to] += weight_of(along);
    table_[to].distance += weight_of(along) * distance;
    table_[to].side = Known::nodes;
  };
  for (std::uint32_t low = 0; low < points(); ++low) {
    LatticePoint next = place(low);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::uint32_t nearest = table_[low].first[axis];
      if (nearest == kNone) continue;
      std::uint32_t farthest = nearest;
      for (std::uint32_t node = nearest; node != kNone; node = nodes_[node].next) {
        if (nodes_[node].at < nodes_[nearest].at) nearest = node;
        if (nodes_[node].at > nodes_[farthest].at) farthest = node;
      }
      ++next[axis];
      const std::uint32_t high = find(next);
      --next[axis];
      const Node& first = nodes_[nearest];
      const Node& last = nodes_[farthest];
      vote(low, first.at, -first.facing * first.at);
      vote(high, 1.0F - last.at, last.facing * (1.0F - last.at));
    }
  }
  for (std::uint32_t k = 0; k < points(); ++k) {
    if (table_[k].side == Known::nodes) table_[k].distance /= weights[k];
  }
}

void SurfaceLattice::decide(const std::vector<std::uint32_t>& numbers, const scene::WindingNumber& winding,
                            const Context& context) {
  context.pool.for_ranges(numbers.size(), 256, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t k = begin; k < end; ++k) {
      const LatticePoint p = place(numbers[k]);
      const Eigen::Vector3f at(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
      // About a spacing far where the winding number is 0 or 1.
      table_[numbers[k]].distance = static_cast<float>(1.0 - 2.0 * winding.at(at));
      table_[numbers[k]].side = Known::winding;
    }
  });
}

SurfaceLattice::Passage SurfaceLattice::passage(std::uint32_t low, std::uint32_t high, int axis) const {
  constexpr float kLeast = 0.02F;  // from a point of the lattice, so that no two vertices are in one place
  const Point& from = table_[low];
  const bool leaves = inside(low);
  float sum = 0.0F;
  int count = 0;
  for (std::uint32_t node = from.first[static_cast<std::size_t>(axis)]; node != kNone; node = nodes_[node].next) {
    if ((nodes_[node].facing > 0.0F) != leaves) continue;
    sum += nodes_[node].at;
    ++count;
  }
  const float there = table_[high].distance;
  const float at = count > 0 ? sum / static_cast<float>(count) : from.distance / (from.distance - there);
  const bool told = count > 0 || (measured(low) && measured(high));
  return {std::clamp(at, kLeast, 1.0F - kLeast), told};
}

}  // namespace sparsha::pipeline
