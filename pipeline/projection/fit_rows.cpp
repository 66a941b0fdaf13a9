// Most nodes are decided by the kernel, eight at a time; then neighbours are compared.
#include "pipeline/projection/fit_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kRows = 16;

using Radii = std::array<std::vector<float>, 3>;

// 1/R^2 of the kernel by the number of front points in a window of `area` nodes, as far as that changes anything.
std::vector<float> radii_of_window(double area) {
  std::vector<float> per_r2(1, 0.0F);
  for (std::size_t points = 1; points < NodeKernel::kMostPoints; ++points) {
    const double spacing = std::max(1.0, std::sqrt(area / static_cast<double>(points)));
    const double radius = kernel_radius(spacing, points, area);
    per_r2.push_back(static_cast<float>(1.0 / (radius * radius)));
    if (radius <= least_kernel_radius()) break;
  }
  return per_r2;
}

const Radii& kernel_radii() {
  static const Radii radii{radii_of_window(9.0), radii_of_window(25.0), radii_of_window(49.0)};
  return radii;
}

NodeKernel node_kernel(const Bins& bins, double noise_m) {
  const BinLattice& lattice = bins.lattice;
  const double scale = residual_scale(noise_m, lattice.spacing_m);
  NodeKernel kernel;
  kernel.start = bins.start.get();
  kernel.x = bins.x.get();
  kernel.y = bins.y.get();
  kernel.z = bins.z.get();
  kernel.bins_x = static_cast<std::size_t>(lattice.bins_x());
  kernel.margin = BinLattice::kMargin;
  kernel.nx = static_cast<std::size_t>(lattice.nx);
  kernel.x0_m = lattice.x0_m;
  kernel.y0_m = lattice.y0_m;
  kernel.spacing_m = lattice.spacing_m;
  kernel.band_m = static_cast<float>(6.0 * noise_m + 2.25 * lattice.spacing_m);
  kernel.scale_m = static_cast<float>(scale);
  kernel.ridge = static_cast<float>(slope_ridge(scale, lattice.spacing_m));
  for (std::size_t window = 0; window < kernel_radii().size(); ++window) {
    kernel.per_r2[window] = kernel_radii()[window].data();
    kernel.most_of[window] = kernel_radii()[window].size() - 1;
  }
  return kernel;
}

// Simple nodes by the kernel, a few rows at a time; the others by NodeFitter.
void fit_nodes(const Bins& bins, const NodeFitParameters& rule, int first_row, const Context& context,
               scene::DepthGrid& grid) {
  const auto first = static_cast<std::size_t>(first_row);
  const NodeKernel shared = node_kernel(bins, rule.noise_m);
  context.pool.for_ranges(static_cast<std::size_t>(grid.lattice.ny), kRows, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    NodeFitter fitter(bins, rule);
    const auto scratch = make_buffer<float>(NodeKernel::kScratch);
    NodeKernel kernel = shared;
    kernel.scratch = scratch.get();
    std::vector<std::uint8_t> verdict((end - begin) * kernel.nx);
    const std::size_t at = begin * kernel.nx;
    fastest_kernels().fit_rows(kernel, first + begin, first + end, grid.height_m.data() + at, verdict.data());
    for (std::size_t node = 0; node < verdict.size(); ++node) {
      if (verdict[node] == NodeKernel::kUnknown) continue;
      if (verdict[node] == NodeKernel::kHard) {
        context.progress.throw_if_cancelled();
        const int j = first_row + static_cast<int>(begin + node / kernel.nx);
        const NodeFit fit = fitter.fit(static_cast<int>(node % kernel.nx), j);
        if (!fit.measured) continue;
        grid.height_m[at + node] = static_cast<float>(fit.height_m);
      }
      grid.state[at + node] = scene::NodeState::measured;
    }
  });
}

// True when a node stands alone below `above_m` among its eight neighbours. Windows of 3x3 or 5x5 nodes see the back
// there when chance has put their front points to one side: about once in 200 000 nodes where the back is as dense.
bool is_lone_pit(const scene::DepthGrid& grid, std::size_t i, std::size_t j, float above_m) {
  const auto nx = static_cast<std::size_t>(grid.lattice.nx);
  const auto ny = static_cast<std::size_t>(grid.lattice.ny);
  int higher = 0;
  int as_low = -1;  // the node itself
  for (std::size_t b = j > 0 ? j - 1 : 0; b <= std::min(ny - 1, j + 1); ++b) {
    for (std::size_t a = i > 0 ? i - 1 : 0; a <= std::min(nx - 1, i + 1); ++a) {
      const float height = grid.height_m[b * nx + a];
      higher += height > above_m ? 1 : 0;
      as_low += height <= above_m ? 1 : 0;
    }
  }
  constexpr int kLeast = 2;
  return as_low == 0 && higher >= kLeast;
}

// A node far below a neighbour, with a point or two at the neighbour's height in its window, may have missed a front
// that chance has thinned there: wider windows decide again.
void look_again(const Bins& bins, const NodeFitParameters& rule, double gap_m, int first_row, const Context& context,
                scene::DepthGrid& grid) {
  const scene::Lattice& lattice = grid.lattice;
  const auto nx = static_cast<std::size_t>(lattice.nx);
  const auto ny = static_cast<std::size_t>(lattice.ny);
  const auto gap = static_cast<float>(gap_m);
  struct Change {
    std::size_t node;
    NodeFit fit;
    bool forget;  // when the fit fails
  };
  std::vector<std::vector<Change>> changes((ny + kRows - 1) / kRows);
  context.pool.for_ranges(ny, kRows, [&](std::size_t begin, std::size_t end) {
    NodeFitter fitter(bins, rule);
    // One more on either side; unknown heights are NaN and never win a comparison.
    std::vector<float> highest(nx + 2);
    for (std::size_t j = begin; j < end; ++j) {
      std::fill(highest.begin(), highest.end(), -std::numeric_limits<float>::infinity());
      for (std::size_t b = j == 0 ? 0 : j - 1; b <= std::min(ny - 1, j + 1); ++b) {
        const float* row = grid.height_m.data() + b * nx;
        for (std::size_t i = 0; i < nx; ++i) highest[i + 1] = row[i] > highest[i + 1] ? row[i] : highest[i + 1];
      }
      const float* row = grid.height_m.data() + j * nx;
      for (std::size_t i = 0; i < nx; ++i) {
        const float neighbour = std::max(highest[i], std::max(highest[i + 1], highest[i + 2]));
        if (!(neighbour - row[i] > gap)) [[likely]]
          continue;
        context.progress.throw_if_cancelled();
        const auto a = static_cast<int>(i);
        const int b = first_row + static_cast<int>(j);
        if (is_lone_pit(grid, i, j, row[i] + gap)) {
          NodeFit fit = fitter.fit(a, b, 3);
          // What is no wider than a node cannot be told from chance: then it is unknown.
          fit.measured = fit.measured && fit.height_m > static_cast<double>(row[i] + gap);
          changes[begin / kRows].push_back({j * nx + i, fit, true});
        } else if (fitter.misses_thin_front(a, b, row[i] + gap)) {
          changes[begin / kRows].push_back({j * nx + i, fitter.fit(a, b, 2), false});
        }
      }
    }
  });
  for (const std::vector<Change>& of_rows : changes) {
    for (const Change& change : of_rows) {
      if (!change.fit.measured) {
        if (!change.forget) continue;
        grid.height_m[change.node] = scene::kUnknownHeight;
        grid.state[change.node] = scene::NodeState::unknown;
        continue;
      }
      grid.height_m[change.node] = static_cast<float>(change.fit.height_m);
    }
  }
}

}  // namespace

void fit_rows(const Bins& bins, const NodeFitParameters& rule, double gap_m, int first_row, const Context& context,
              scene::DepthGrid& rows) {
  fit_nodes(bins, rule, first_row, context, rows);
  look_again(bins, rule, gap_m, first_row, context, rows);
}

// A point of the widest window lies half a node beyond it at most, rounding included one, and density is counted about
// the points in windows of half the size.
int widest_look(const NodeFitParameters& rule) { return rule.widest_window + 1 + (rule.widest_window + 1) / 2; }

}  // namespace sparsha::pipeline
