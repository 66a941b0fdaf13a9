// Sorted in pieces of fixed length, which are merged: the same order for any number of threads.
#include "pipeline/filter/cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sparsha::pipeline {
namespace {

// Below the reach over the square root of 3 by more than all roundings: a point's cell is off by at most 2^-28 of a
// cell wherever two different float32 coordinates share one.
constexpr double kCellsPerReach = 1.7320508075688772 * (1.0 + 1e-6);
constexpr std::size_t kPiece = std::size_t{1} << 18;
constexpr std::size_t kCellsATime = 1024;

struct Entry {
  std::array<double, 3> cell;
  std::uint32_t index;
};

bool before(const Entry& a, const Entry& b) { return std::tie(a.cell, a.index) < std::tie(b.cell, b.index); }

void sort_entries(std::vector<Entry>& entries, const Context& context) {
  const std::size_t count = entries.size();
  const auto at = [&](std::size_t n) { return entries.begin() + static_cast<std::ptrdiff_t>(std::min(n, count)); };
  context.pool.for_ranges(count, kPiece, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    std::sort(at(begin), at(end), before);
  });
  for (std::size_t length = kPiece; length < count; length *= 2) {
    const std::size_t pairs = (count + 2 * length - 1) / (2 * length);
    context.pool.for_ranges(pairs, 1, [&](std::size_t pair, std::size_t) {
      context.progress.throw_if_cancelled();
      const std::size_t begin = pair * 2 * length;
      std::inplace_merge(at(begin), at(begin + length), at(begin + 2 * length), before);
    });
  }
}

}  // namespace

CellOrder::CellOrder(const Cloud& cloud, double reach_m, const Context& context) {
  sort_points(cloud, kCellsPerReach / reach_m, context);
  context.pool.for_ranges(cells(), kCellsATime, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto first = points_.begin() + first_[cell];
      std::sort(first, points_.begin() + first_[cell + 1], [](const Point& a, const Point& b) {
        return std::tie(a.x, a.y, a.z, a.index) < std::tie(b.x, b.y, b.z, b.index);
      });
    }
  });
}

void CellOrder::sort_points(const Cloud& cloud, double per_m, const Context& context) {
  std::vector<Entry> entries(cloud.size());
  const float* const xyz = cloud.xyz1();
  context.pool.for_ranges(entries.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto cell = [&](std::size_t axis) { return std::floor(static_cast<double>(xyz[4 * i + axis]) * per_m); };
      entries[i] = {{cell(2), cell(1), cell(0)}, static_cast<std::uint32_t>(i)};
    }
  });
  sort_entries(entries, context);
  points_.reserve(entries.size());
  for (const Entry& entry : entries) {
    if (cells_.empty() || cells_.back() != entry.cell) {
      cells_.push_back(entry.cell);
      first_.push_back(static_cast<std::uint32_t>(points_.size()));
    }
    const float* const p = xyz + std::size_t{4} * entry.index;
    points_.push_back({p[0], p[1], p[2], entry.index});
  }
  first_.push_back(static_cast<std::uint32_t>(points_.size()));
}

const std::array<CellOrder::Range, 25>& CellOrder::Sweep::near(std::size_t cell) {
  const std::vector<Cell>& cells = order_.cells_;
  const Cell& here = cells[cell];
  std::size_t row = 0;
  for (const double dz : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
    for (const double dy : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
      const Cell low{here[0] + dz, here[1] + dy, here[2] - 2.0};
      const Cell high{low[0], low[1], here[2] + 2.0};
      Range& range = ranges_[row++];
      if (!started_) {
        range.first = static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), low) - cells.begin());
        range.last = range.first;
      }
      while (range.first < cells.size() && cells[range.first] < low) ++range.first;
      range.last = std::max(range.last, range.first);
      while (range.last < cells.size() && cells[range.last] <= high) ++range.last;
    }
  }
  started_ = true;
  return ranges_;
}

}  // namespace sparsha::pipeline
