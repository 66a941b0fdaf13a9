// Building a tree costs more than asking it. Each strip of rows builds its own over the points within a reach of its
// sampled nodes; nodes whose nearest point lies beyond are asked again with a larger reach, at last of all points.
// Where many points come to a node, a tree would be large for few questions: each point is then held against the nodes
// about it, which takes no memory for points.
#include "pipeline/check/nearest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/check/tree.h"
#include "pipeline/layers/closing.h"

namespace sparsha::pipeline {
namespace {

constexpr double kLeastReach = 0.5;  // spacings, of the first try
constexpr double kFirstReach = 1.0;  // point spacings, of the first try; most nodes have a point this near
constexpr double kGrowth = 2.0;      // of the reach from try to try
constexpr double kTrusted = 0.99;    // of the reach; the rest is for the rounding of floats
constexpr int kStripRows = 48;       // node rows with a tree of their own
constexpr int kCellsPerReach = 3;    // resolution of the mask of kept places
constexpr std::size_t kNodesPerPiece = 1024;
constexpr std::size_t kMostOfTree = 1U << 18U;  // points of a tree over all points
constexpr std::uint64_t kManyPerNode = 8;       // points to a node of the lattice, from which no trees are built
constexpr std::size_t kNotAsked = ~std::size_t{0};

/// Places within `reach` (spacings) of a node of some rows, as cells of reach / kCellsPerReach.
class Mask {
 public:
  Mask(int nx, double first_row, double last_row, double reach)
      : reach_(reach),
        y0_(static_cast<float>(first_row - reach)),
        per_cell_(static_cast<float>(kCellsPerReach / reach)),
        marked_(column(nx - 1 + reach) + 1, row(last_row + reach) + 1) {}

  void mark(double x, double y) {
    const int i0 = column(x - reach_), i1 = column(x + reach_), j0 = row(y - reach_), j1 = row(y + reach_);
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) marked_.insert(i, j);
  }
  [[nodiscard]] bool holds(float x, float y) const {
    const float i = (x + static_cast<float>(reach_)) * per_cell_, j = (y - y0_) * per_cell_;
    return i >= 0 && j >= 0 && i < static_cast<float>(marked_.nx()) && j < static_cast<float>(marked_.ny()) &&
           marked_.contains(static_cast<int>(i), static_cast<int>(j));
  }

 private:
  // The mask's size is that of the last place's cell, by the same roundings: none lies beyond.
  [[nodiscard]] int column(double x) const {
    return static_cast<int>((static_cast<float>(x) + static_cast<float>(reach_)) * per_cell_);
  }
  [[nodiscard]] int row(double y) const { return static_cast<int>((static_cast<float>(y) - y0_) * per_cell_); }

  double reach_;
  float y0_, per_cell_;
  NodeSet marked_;
};

class Search {
 public:
  Search(const scene::DepthGrid& grid, const std::vector<std::uint64_t>& nodes, const CountedPoints& points)
      : result(nodes.size(), std::numeric_limits<float>::infinity()),
        grid_(grid),
        nodes_(nodes),
        points_(points),
        nx_(static_cast<std::uint64_t>(grid.lattice.nx)),
        spacing_(grid.lattice.spacing_m) {}

  std::vector<float> result;

  /// Node k's nearest among the tree's points, when it is nearer than what is known.
  void ask(const PointTree& tree, std::span<const float> xyz, std::size_t k, PointTree::Answer& answer) {
    const std::uint64_t node = nodes_[k];
    const double x = column(node) * spacing_, y = row(node) * spacing_, z = grid_.height_m[node];
    if (!tree.nearest(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), answer)) return;
    offer(xyz.data() + 3 * static_cast<std::size_t>(answer.index[0]), k);
  }

  /// Node k's nearest, if it is this point; of equally near ones one above the node, so that their order means nothing.
  void offer(const float* point, std::size_t k) {
    const std::uint64_t node = nodes_[k];
    const double x = column(node) * spacing_, y = row(node) * spacing_, z = grid_.height_m[node];
    const double dx = point[0] - x, dy = point[1] - y, dz = point[2] - z;
    const auto found = static_cast<float>(std::copysign(std::sqrt(dx * dx + dy * dy + dz * dz), dz));
    const float known = std::abs(result[k]);
    if (std::abs(found) < known || (std::abs(found) == known && found > result[k])) result[k] = found;
  }

  /// As strip(), point by point.
  std::vector<std::size_t> dense_strip(std::size_t strip, std::size_t begin, std::size_t end, double reach) {
    std::vector<std::size_t> open;
    for (std::size_t k = begin; k < end; ++k) open.push_back(k);
    const std::size_t first = strip * kStripRows, row_nodes = nx_;
    const double last_row =
        std::min<double>(kStripRows, static_cast<double>(grid_.lattice.ny) - static_cast<double>(first)) - 1;
    const double per_spacing = 1 / spacing_, last_column = static_cast<double>(nx_) - 1;
    std::vector<std::size_t> asked;  // by node of the strip
    for (; !open.empty() && reach < kStripRows; reach *= kGrowth) {
      asked.assign(kStripRows * row_nodes, kNotAsked);
      for (const std::size_t k : open) asked[nodes_[k] - first * row_nodes] = k;
      const auto from = static_cast<double>(first);
      points_.in_rows(from - reach, from + last_row + reach, [&](std::span<const float> xyz) {
        for (std::size_t p = 0; p < xyz.size(); p += 3) {
          const double i = xyz[p] * per_spacing, j = xyz[p + 1] * per_spacing - from;
          const double left = std::max(std::ceil(i - reach), 0.0), right = std::min(std::floor(i + reach), last_column);
          const double low = std::max(std::ceil(j - reach), 0.0), high = std::min(std::floor(j + reach), last_row);
          for (double b = low; b <= high; ++b)
            for (double a = left; a <= right; ++a) {
              const std::size_t k = asked[static_cast<std::size_t>(b) * row_nodes + static_cast<std::size_t>(a)];
              if (k != kNotAsked) offer(xyz.data() + p, k);
            }
        }
      });
      std::erase_if(open, [&](std::size_t k) { return std::abs(result[k]) <= kTrusted * reach * spacing_; });
    }
    return open;
  }

  /// Answers the nodes [begin, end) of one strip; returns those that the points within a strip's height cannot decide.
  std::vector<std::size_t> strip(std::size_t strip, std::size_t begin, std::size_t end, double reach) {
    std::vector<std::size_t> open;
    for (std::size_t k = begin; k < end; ++k) open.push_back(k);
    const double first = static_cast<double>(strip) * kStripRows, last = first + kStripRows - 1;
    const auto per_spacing = static_cast<float>(1 / spacing_);
    std::vector<std::array<float, 3>> chosen;
    PointTree::Answer answer;
    for (; !open.empty() && reach < kStripRows; reach *= kGrowth) {
      Mask mask(grid_.lattice.nx, first, last, reach);
      for (const std::size_t k : open) mask.mark(column(nodes_[k]), row(nodes_[k]));
      chosen.clear();
      points_.in_rows(first - reach, last + reach, [&](std::span<const float> xyz) {
        for (std::size_t p = 0; p < xyz.size(); p += 3) {
          if (mask.holds(xyz[p] * per_spacing, xyz[p + 1] * per_spacing)) {
            chosen.push_back({xyz[p], xyz[p + 1], xyz[p + 2]});
          }
        }
      });
      // Of points at equal distances a tree names the one that it met first.
      std::sort(chosen.begin(), chosen.end());
      const std::span<const float> xyz(chosen.empty() ? nullptr : chosen.front().data(), 3 * chosen.size());
      const PointTree tree(xyz);
      for (const std::size_t k : open) ask(tree, xyz, k, answer);
      std::erase_if(open, [&](std::size_t k) { return std::abs(result[k]) <= kTrusted * reach * spacing_; });
    }
    return open;
  }

 private:
  [[nodiscard]] double column(std::uint64_t node) const { return static_cast<double>(node % nx_); }
  [[nodiscard]] double row(std::uint64_t node) const { return static_cast<double>(node / nx_); }

  const scene::DepthGrid& grid_;
  const std::vector<std::uint64_t>& nodes_;
  const CountedPoints& points_;
  std::uint64_t nx_;
  double spacing_;
};

}  // namespace

std::vector<float> nearest_point_distances(const scene::DepthGrid& grid, const std::vector<std::uint64_t>& nodes,
                                           const CountedPoints& points, double point_spacing_m, ThreadPool& pool) {
  Search search(grid, nodes, points);
  if (nodes.empty() || points.size == 0) return std::move(search.result);
  const double reach = std::max(kLeastReach, kFirstReach * point_spacing_m / grid.lattice.spacing_m);
  const std::size_t strip_nodes = kStripRows * static_cast<std::size_t>(grid.lattice.nx);
  const bool dense = points.size / kManyPerNode >= grid.lattice.count();
  std::vector<std::vector<std::size_t>> undecided((grid.lattice.count() + strip_nodes - 1) / strip_nodes);
  pool.for_ranges(undecided.size(), 1, [&](std::size_t strip, std::size_t) {
    const auto begin = std::lower_bound(nodes.begin(), nodes.end(), strip * strip_nodes);
    const auto end = std::lower_bound(begin, nodes.end(), (strip + 1) * strip_nodes);
    const auto from = static_cast<std::size_t>(begin - nodes.begin()),
               to = static_cast<std::size_t>(end - nodes.begin());
    undecided[strip] = dense ? search.dense_strip(strip, from, to, reach) : search.strip(strip, from, to, reach);
  });
  std::vector<std::size_t> open;
  for (const std::vector<std::size_t>& some : undecided) open.insert(open.end(), some.begin(), some.end());
  if (!open.empty()) {
    points.each([&](std::span<const float> all) {
      for (std::size_t from = 0; from < all.size(); from += 3 * kMostOfTree) {
        const std::span<const float> xyz = all.subspan(from, std::min(3 * kMostOfTree, all.size() - from));
        const PointTree tree(xyz);
        pool.for_ranges(open.size(), kNodesPerPiece, [&](std::size_t begin, std::size_t end) {
          PointTree::Answer answer;
          for (std::size_t n = begin; n < end; ++n) search.ask(tree, xyz, open[n], answer);
        });
      }
    });
  }
  return std::move(search.result);
}

}  // namespace sparsha::pipeline
