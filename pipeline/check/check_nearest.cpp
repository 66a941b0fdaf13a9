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

constexpr double kFirstReach = 1.6;  // point spacings; most nodes have a point this near
constexpr double kGrowth = 4.0;      // of the reach from try to try
constexpr double kWorthwhile = 0.7;  // share of the lattice above which leaving points out saves nothing
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

}  // namespace

std::vector<float> nearest_point_distances(const DepthGrid& grid, const std::vector<std::uint32_t>& nodes,
                                           std::span<const float> xyz, double point_spacing_m, ThreadPool& pool) {
  const Lattice& lattice = grid.lattice;
  const auto nx = static_cast<std::uint32_t>(lattice.nx);
  const double h = lattice.spacing_m, longest = std::max(lattice.nx, lattice.ny);
  std::vector<float> result(nodes.size(), std::numeric_limits<float>::infinity());
  std::vector<std::uint32_t> open(nodes.size());
  for (std::size_t k = 0; k < open.size(); ++k) open[k] = static_cast<std::uint32_t>(k);

  double reach = std::max(0.5, kFirstReach * point_spacing_m / h);
  while (!open.empty() && !xyz.empty()) {
    const double kept = static_cast<double>(open.size()) * 4 * reach * reach / static_cast<double>(lattice.count());
    const bool everything = reach > longest || 1 - std::exp(-kept) > kWorthwhile;
    std::vector<float> near;
    if (!everything) {
      Mask mask(lattice, reach);
      for (const std::uint32_t k : open) mask.mark(nodes[k] % nx, static_cast<double>(nodes[k] / nx));
      for (std::size_t p = 0; p + 2 < xyz.size(); p += 3)
        if (mask.holds(xyz[p] / h, xyz[p + 1] / h))
          near.insert(near.end(), xyz.begin() + static_cast<std::ptrdiff_t>(p),
                      xyz.begin() + static_cast<std::ptrdiff_t>(p + 3));
    }
    const std::span<const float> points = everything ? xyz : std::span<const float>(near);
    const PointTree tree(points);
    pool.for_ranges(open.size(), kNodesPerPiece, [&](std::size_t begin, std::size_t end) {
      PointTree::Answer answer;
      for (std::size_t n = begin; n < end; ++n) {
        const std::uint32_t node = nodes[open[n]];
        const auto x = static_cast<float>((node % nx) * h), y = static_cast<float>((node / nx) * h);
        const float z = grid.height_m[node];
        if (!tree.nearest(x, y, z, answer)) continue;
        const float* point = points.data() + 3 * static_cast<std::size_t>(answer.index[0]);
        const double dx = point[0] - (node % nx) * h, dy = point[1] - (node / nx) * h, dz = point[2] - z;
        result[open[n]] = static_cast<float>(std::copysign(std::sqrt(dx * dx + dy * dy + dz * dz), dz));
      }
    });
    if (everything) break;
    std::erase_if(open, [&](std::uint32_t k) { return std::abs(result[k]) <= reach * h; });
    reach *= kGrowth;
  }
  return result;
}

}  // namespace sparsha::pipeline
