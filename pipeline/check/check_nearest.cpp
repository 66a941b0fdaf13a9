// Building a tree costs more than asking it: points farther than a reach from every sampled node in x or y are left
// out, and nodes whose nearest point then lies beyond that reach are asked again with a larger one. The answers are
// exact.
#include "pipeline/check/check_nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/check/check_tree.h"

namespace sparsha::pipeline {
namespace {

constexpr double kLeastReach = 0.5;  // spacings, of the first try
constexpr double kFirstReach = 1.0;  // point spacings, of the first try; most nodes have a point this near
constexpr double kGrowth = 2.0;      // of the reach from try to try
constexpr double kWorthwhile = 1.2;  // lattices' worth of area above which leaving points out saves nothing
constexpr int kCellsPerReach = 2;    // resolution of the mask of kept places
constexpr std::size_t kNodesPerPiece = 1024;

/// Places within `reach` (spacings) of a node, as cells of reach / kCellsPerReach.
class Mask {
 public:
  Mask(const Lattice& lattice, double reach)
      : reach_(reach),
        cell_(reach / kCellsPerReach),
        nx_(static_cast<std::size_t>((lattice.nx + 2 * reach) / cell_) + 2),
        ny_(static_cast<std::size_t>((lattice.ny + 2 * reach) / cell_) + 2),
        marked_(nx_ * ny_) {}

  void mark(double x, double y) {
    const std::size_t i0 = place(x - reach_), i1 = place(x + reach_), j0 = place(y - reach_), j1 = place(y + reach_);
    for (std::size_t j = j0; j <= j1; ++j)
      std::fill_n(marked_.begin() + static_cast<std::ptrdiff_t>(j * nx_ + i0), i1 - i0 + 1, std::uint8_t{1});
  }
  [[nodiscard]] bool holds(double x, double y) const {
    if (!(x > -reach_) || !(y > -reach_)) return false;
    const std::size_t i = place(x), j = place(y);
    return i < nx_ && j < ny_ && marked_[j * nx_ + i] != 0;
  }

 private:
  [[nodiscard]] std::size_t place(double value) const { return static_cast<std::size_t>((value + reach_) / cell_); }

  double reach_, cell_;
  std::size_t nx_, ny_;
  std::vector<std::uint8_t> marked_;
};

/// A band of node rows with its own tree: small trees are built and asked out of the cache, and bands run side by side.
class Bands {
 public:
  Bands(const Lattice& lattice, double reach)
      : rows_(std::max(kLeastRows, static_cast<int>(std::ceil(reach)) + 1)), count_((lattice.ny + rows_ - 1) / rows_) {}

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(count_); }
  /// The band of a row or of a y in spacings; what lies beyond the lattice belongs to the nearest band.
  [[nodiscard]] std::size_t of(double row) const {
    return static_cast<std::size_t>(std::clamp(row / rows_, 0.0, count_ - 1.0));
  }

 private:
  static constexpr int kLeastRows = 48;
  int rows_, count_;
};

}  // namespace

std::vector<float> nearest_point_distances(const DepthGrid& grid, const std::vector<std::uint32_t>& nodes,
                                           std::span<const float> xyz, double point_spacing_m, ThreadPool& pool) {
  const Lattice& lattice = grid.lattice;
  const auto nx = static_cast<std::uint32_t>(lattice.nx);
  const double h = lattice.spacing_m, longest = std::max(lattice.nx, lattice.ny);
  std::vector<float> result(nodes.size(), std::numeric_limits<float>::infinity());
  std::vector<std::uint32_t> open(nodes.size());
  for (std::size_t k = 0; k < open.size(); ++k) open[k] = static_cast<std::uint32_t>(k);

  const auto ask = [&](const PointTree& tree, std::span<const float> points, std::uint32_t k,
                       PointTree::Answer& answer) {
    const std::uint32_t node = nodes[k];
    const double x = (node % nx) * h, y = (node / nx) * h, z = grid.height_m[node];
    if (!tree.nearest(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), answer)) return;
    const float* point = points.data() + 3 * static_cast<std::size_t>(answer.index[0]);
    const double dx = point[0] - x, dy = point[1] - y, dz = point[2] - z;
    result[k] = static_cast<float>(std::copysign(std::sqrt(dx * dx + dy * dy + dz * dz), dz));
  };

  double reach = std::max(kLeastReach, kFirstReach * point_spacing_m / h);
  for (; !open.empty() && !xyz.empty(); reach *= kGrowth) {
    const double kept = static_cast<double>(open.size()) * 4 * reach * reach / static_cast<double>(lattice.count());
    if (reach > longest || kept > kWorthwhile) {
      const PointTree tree(xyz);
      pool.for_ranges(open.size(), kNodesPerPiece, [&](std::size_t begin, std::size_t end) {
        PointTree::Answer answer;
        for (std::size_t n = begin; n < end; ++n) ask(tree, xyz, open[n], answer);
      });
      break;
    }
    Mask mask(lattice, reach);
    for (const std::uint32_t k : open) mask.mark(nodes[k] % nx, static_cast<double>(nodes[k] / nx));
    const Bands bands(lattice, reach);
    std::vector<std::vector<float>> points(bands.count());
    for (std::size_t p = 0; p + 2 < xyz.size(); p += 3) {
      if (!mask.holds(xyz[p] / h, xyz[p + 1] / h)) continue;
      // A band also needs what its neighbours' points within reach of its border can tell.
      const double row = xyz[p + 1] / h;
      for (std::size_t band = bands.of(row - reach); band <= bands.of(row + reach); ++band)
        points[band].insert(points[band].end(), xyz.begin() + static_cast<std::ptrdiff_t>(p),
                            xyz.begin() + static_cast<std::ptrdiff_t>(p + 3));
    }
    std::vector<std::vector<std::uint32_t>> members(bands.count());
    for (const std::uint32_t k : open) members[bands.of(nodes[k] / nx)].push_back(k);
    pool.for_ranges(bands.count(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t band = begin; band < end; ++band) {
        if (members[band].empty()) continue;
        const PointTree tree(points[band]);
        PointTree::Answer answer;
        for (const std::uint32_t k : members[band]) ask(tree, points[band], k, answer);
      }
    });
    std::erase_if(open, [&](std::uint32_t k) { return std::abs(result[k]) <= reach * h; });
  }
  return result;
}

}  // namespace sparsha::pipeline
