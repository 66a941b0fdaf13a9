// Coarser levels: the binomial low-pass [1 6 15 20 15 6 1]/64 before every halving. It is non-negative and its response
// cos^6(pi f) falls to 1.6 % at 1/3 cycle per node; being totally positive along a row it makes no new extrema there
// (Lindeberg 1990), so that no detail is invented between levels.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/layers/layers.h"
#include "scene/ground/window_lattice.h"

namespace sparsha::pipeline {
namespace {

constexpr int kReach = 3;
constexpr std::array<int, 7> kBinomial64 = {1, 6, 15, 20, 15, 6, 1};  // 64ths
constexpr std::array<double, 7> kBinomial = {1.0 / 64, 6.0 / 64, 15.0 / 64, 20.0 / 64, 15.0 / 64, 6.0 / 64, 1.0 / 64};
constexpr std::size_t kRowsPerPiece = 16;
constexpr double kDegenerate = 1e-6;  // determinant of the support's spread below which it carries no slope

/// The lattice of the next level: node (i, j) is node (2i, 2j) of the finer one.
scene::Lattice halved(const scene::Lattice& fine) {
  scene::Lattice coarse = fine;
  coarse.nx = (fine.nx + 1) / 2;
  coarse.ny = (fine.ny + 1) / 2;
  coarse.spacing_m = 2 * fine.spacing_m;
  return coarse;
}

/// How much of the low-pass weight about the nodes of one row lies on measured and on known nodes, in 64ths by 64ths.
class Supports {
 public:
  explicit Supports(int nx)
      : total_(static_cast<std::size_t>(nx)),
        measured_(static_cast<std::size_t>(nx)),
        known_(static_cast<std::size_t>(nx)) {}

  /// Sums the columns of the window rows about row cj.
  void read(const scene::DepthGrid& grid, int cj) {
    std::fill(total_.begin(), total_.end(), 0);
    std::fill(measured_.begin(), measured_.end(), 0);
    std::fill(known_.begin(), known_.end(), 0);
    for (int k = -kReach; k <= kReach; ++k) {
      if (cj + k < 0 || cj + k >= grid.lattice.ny) continue;
      const int weight = kBinomial64[static_cast<std::size_t>(k + kReach)];
      const scene::NodeState* states = grid.state.data() + grid.lattice.index(0, cj + k);
      for (std::size_t i = 0; i < total_.size(); ++i) {
        total_[i] += weight;
        measured_[i] += states[i] == scene::NodeState::measured ? weight : 0;
        known_[i] += states[i] != scene::NodeState::unknown ? weight : 0;
      }
    }
  }
  /// State of the coarse node on column ci: known when half its support is, measured when half of it is.
  [[nodiscard]] scene::NodeState state(int ci) const {
    int total = 0, measured = 0, known = 0;
    for (int k = -kReach; k <= kReach; ++k) {
      if (ci + k < 0 || ci + k >= static_cast<int>(total_.size())) continue;
      const int weight = kBinomial64[static_cast<std::size_t>(k + kReach)];
      const auto n = static_cast<std::size_t>(ci + k);
      total += weight * total_[n];
      measured += weight * measured_[n];
      known += weight * known_[n];
    }
    if (2 * known < total) return scene::NodeState::unknown;
    return 2 * measured >= total ? scene::NodeState::measured : scene::NodeState::filled;
  }

 private:
  std::vector<int> total_, measured_, known_;
};

/// One node of the window with its weight; offsets in fine spacings.
struct Member {
  std::size_t index;
  double dx, dy, weight;
};

/// The window about fine node (ci, cj), clipped at the lattice's border.
struct Window {
  std::array<Member, 49> members;
  std::size_t count = 0;
  double known = 0;  ///< weight on measured or filled nodes

  Window(const scene::DepthGrid& grid, int ci, int cj) {
    const scene::Lattice& lattice = grid.lattice;
    for (int dy = -kReach; dy <= kReach; ++dy)
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int i = ci + dx, j = cj + dy;
        if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) continue;
        const double weight =
            kBinomial[static_cast<std::size_t>(dx + kReach)] * kBinomial[static_cast<std::size_t>(dy + kReach)];
        const std::size_t n = lattice.index(i, j);
        if (grid.state[n] == scene::NodeState::unknown) continue;
        known += weight;
        members[count++] = {n, static_cast<double>(dx), static_cast<double>(dy), weight};
      }
  }

  /// Weighted mean of a layer over known nodes; NaN values count nothing.
  template <typename Value>
  [[nodiscard]] double mean(const Value& value) const {
    double sum = 0, weight = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double v = value(members[k].index);
      if (std::isnan(v)) continue;
      sum += members[k].weight * v;
      weight += members[k].weight;
    }
    return weight > 0 ? sum / weight : scene::kUnknownHeight;
  }

  /// Value of the weighted plane at the window's centre: where nodes are missing on one side, a slope stays a slope.
  [[nodiscard]] double plane(const std::vector<float>& layer) const {
    const double z = mean([&](std::size_t n) { return layer[n]; });
    if (!(known > 0)) return scene::kUnknownHeight;
    double x = 0, y = 0;
    for (std::size_t k = 0; k < count; ++k) {
      x += members[k].weight * members[k].dx;
      y += members[k].weight * members[k].dy;
    }
    x /= known;
    y /= known;
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Member& m = members[k];
      const double dx = m.dx - x, dy = m.dy - y, dz = layer[m.index] - z;
      xx += m.weight * dx * dx;
      xy += m.weight * dx * dy;
      yy += m.weight * dy * dy;
      xz += m.weight * dx * dz;
      yz += m.weight * dy * dz;
    }
    const double determinant = xx * yy - xy * xy;
    if (determinant < kDegenerate) return z;
    return z - ((yy * xz - xy * yz) * x + (xx * yz - xy * xz) * y) / determinant;
  }
};

/// Low-pass and halving of a layer where the window is complete; NaN elsewhere (NaN spreads through the sums).
void low_pass_row(const scene::Lattice& fine, const std::vector<float>& layer, int cj, std::vector<double>& column,
                  float* out, int out_count) {
  const int nx = fine.nx;
  column.assign(static_cast<std::size_t>(nx), scene::kUnknownHeight);
  if (cj >= kReach && cj + kReach < fine.ny) {
    std::fill(column.begin(), column.end(), 0.0);
    for (int k = -kReach; k <= kReach; ++k) {
      const float* row = layer.data() + fine.index(0, cj + k);
      const double weight = kBinomial[static_cast<std::size_t>(k + kReach)];
      for (int i = 0; i < nx; ++i) column[static_cast<std::size_t>(i)] += weight * row[i];
    }
  }
  for (int i = 0; i < out_count; ++i) {
    const int c = 2 * i;
    out[i] = scene::kUnknownHeight;
    if (c < kReach || c + kReach >= nx) continue;
    double sum = 0;
    for (int k = -kReach; k <= kReach; ++k)
      sum += kBinomial[static_cast<std::size_t>(k + kReach)] * column[static_cast<std::size_t>(c + k)];
    out[i] = static_cast<float>(sum);
  }
}

std::uint32_t mean_colour(const Window& window, const std::vector<std::uint32_t>& colours) {
  std::uint32_t result = 0;
  for (int shift = 0; shift < 32; shift += 8) {
    // A transparent node has no colour to give.
    const double mean = window.mean([&](std::size_t n) {
      const std::uint32_t c = colours[n];
      return (c >> 24) == 0 ? static_cast<double>(scene::kUnknownHeight) : static_cast<double>((c >> shift) & 0xFFU);
    });
    if (!std::isnan(mean)) result |= static_cast<std::uint32_t>(std::lround(mean)) << shift;
  }
  return result;
}

/// Halves one optional layer; `unknown` is what it holds where the coarse node is unknown.
std::vector<float> halve_layer(const scene::Layers& fine, const scene::DepthGrid& coarse,
                               const std::vector<float>& layer, bool heights, float unknown, ThreadPool& pool) {
  if (layer.empty()) return {};
  std::vector<float> result(coarse.lattice.count());
  const int nx = coarse.lattice.nx;
  pool.for_ranges(static_cast<std::size_t>(coarse.lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<double> column;
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
      float* out = result.data() + coarse.lattice.index(0, j);
      low_pass_row(fine.grid.lattice, layer, 2 * j, column, out, nx);
      for (int i = 0; i < nx; ++i) {
        if (coarse.state[coarse.lattice.index(i, j)] == scene::NodeState::unknown) {
          out[i] = unknown;
        } else if (std::isnan(out[i])) {
          const Window window(fine.grid, 2 * i, 2 * j);
          out[i] =
              static_cast<float>(heights ? window.plane(layer) : window.mean([&](std::size_t n) { return layer[n]; }));
        }
      }
    }
  });
  return result;
}

scene::Layers halve(const scene::Layers& fine, ThreadPool& pool) {
  scene::Layers coarse;
  coarse.grid = scene::DepthGrid(halved(fine.grid.lattice));
  scene::DepthGrid& grid = coarse.grid;
  const int nx = grid.lattice.nx;
  pool.for_ranges(static_cast<std::size_t>(grid.lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    Supports supports(fine.grid.lattice.nx);
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
      supports.read(fine.grid, 2 * j);
      for (int i = 0; i < nx; ++i) grid.state[grid.lattice.index(i, j)] = supports.state(2 * i);
    }
  });
  grid.height_m = halve_layer(fine, grid, fine.grid.height_m, true, scene::kUnknownHeight, pool);
  coarse.envelope_m = halve_layer(fine, grid, fine.envelope_m, true, scene::kUnknownHeight, pool);
  coarse.curvature_per_m = halve_layer(fine, grid, fine.curvature_per_m, false, scene::kUnknownHeight, pool);
  coarse.mean_curvature_per_m = halve_layer(fine, grid, fine.mean_curvature_per_m, false, scene::kUnknownHeight, pool);
  coarse.gaussian_curvature_per_m2 =
      halve_layer(fine, grid, fine.gaussian_curvature_per_m2, false, scene::kUnknownHeight, pool);
  coarse.intensity = halve_layer(fine, grid, fine.intensity, false, scene::kUnknownHeight, pool);
  if (!fine.colour_rgba.empty()) {
    coarse.colour_rgba.resize(grid.lattice.count());
    pool.for_ranges(static_cast<std::size_t>(grid.lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
      for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
        for (int i = 0; i < nx; ++i)
          coarse.colour_rgba[grid.lattice.index(i, j)] = mean_colour(Window(fine.grid, 2 * i, 2 * j), fine.colour_rgba);
    });
  }
  return coarse;
}

/// Whether the heights of all four nodes of some cell are known.
bool has_known_cell(const scene::DepthGrid& grid) {
  const scene::Lattice& lattice = grid.lattice;
  const auto known = [&](int i, int j) { return grid.state[lattice.index(i, j)] != scene::NodeState::unknown; };
  for (int j = 0; j + 1 < lattice.ny; ++j)
    for (int i = 0; i + 1 < lattice.nx; ++i)
      if (known(i, j) && known(i + 1, j) && known(i, j + 1) && known(i + 1, j + 1)) return true;
  return false;
}

}  // namespace

std::vector<scene::Layers> build_pyramid(const scene::Layers& base, int window, ThreadPool& pool) {
  std::vector<scene::Layers> levels;
  const scene::Layers* finest = &base;
  while (std::max(finest->grid.lattice.nx, finest->grid.lattice.ny) > std::max(window, 2)) {
    if (!scene::has_cell(halved(finest->grid.lattice))) break;
    scene::Layers coarser = halve(*finest, pool);
    if (!has_known_cell(coarser.grid)) break;
    levels.push_back(std::move(coarser));
    finest = &levels.back();
  }
  return levels;
}

}  // namespace sparsha::pipeline
