// Pull-push (Gortler et al. 1996): averages of known nodes go up a pyramid, unknown nodes take the coarser level's
// value on the way down, relaxed towards a membrane at every level so that no block edge can be felt.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "scene/ground/continuation.h"

namespace sparsha::scene {
namespace {

constexpr int kSweeps = 8;  // relaxations a level; errors longer than that are the coarser level's

struct Grid {
  int nx = 0;
  int ny = 0;
  std::vector<float> value;
  std::vector<std::uint8_t> known;

  Grid(int width, int height)
      : nx(width), ny(height), value(count(width, height), 0.0F), known(count(width, height), 0) {}
  static std::size_t count(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
};

/// Every second node, averaged over the known nodes of its 3x3 neighbourhood with the weights (1 2 1)^2.
Grid pull(const Grid& fine) {
  Grid coarse((fine.nx + 1) / 2, (fine.ny + 1) / 2);
  for (int j = 0; j < coarse.ny; ++j)
    for (int i = 0; i < coarse.nx; ++i) {
      double sum = 0.0;
      double weights = 0.0;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          const int fi = 2 * i + di;
          const int fj = 2 * j + dj;
          if (fi < 0 || fj < 0 || fi >= fine.nx || fj >= fine.ny) continue;
          const std::size_t node = fine.index(fi, fj);
          if (fine.known[node] == 0) continue;
          const double weight = (2 - std::abs(di)) * (2 - std::abs(dj));
          sum += weight * static_cast<double>(fine.value[node]);
          weights += weight;
        }
      if (weights == 0.0) continue;
      coarse.value[coarse.index(i, j)] = static_cast<float>(sum / weights);
      coarse.known[coarse.index(i, j)] = 1;
    }
  return coarse;
}

/// The coarse level's bilinear value at fine node (i, j).
float interpolate(const Grid& coarse, int i, int j) {
  const int i0 = i / 2;
  const int j0 = j / 2;
  const int i1 = std::min(i0 + i % 2, coarse.nx - 1);
  const int j1 = std::min(j0 + j % 2, coarse.ny - 1);
  return 0.25F * (coarse.value[coarse.index(i0, j0)] + coarse.value[coarse.index(i1, j0)] +
                  coarse.value[coarse.index(i0, j1)] + coarse.value[coarse.index(i1, j1)]);
}

/// Gauss-Seidel on the unknown nodes: each the mean of its neighbours, the border reflecting.
void relax(Grid& grid, const std::vector<std::size_t>& unknown) {
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (const std::size_t node : unknown) {
      const int i = static_cast<int>(node % static_cast<std::size_t>(grid.nx));
      const int j = static_cast<int>(node / static_cast<std::size_t>(grid.nx));
      const float left = grid.value[i > 0 ? node - 1 : node];
      const float right = grid.value[i + 1 < grid.nx ? node + 1 : node];
      const float below = grid.value[j > 0 ? node - static_cast<std::size_t>(grid.nx) : node];
      const float above = grid.value[j + 1 < grid.ny ? node + static_cast<std::size_t>(grid.nx) : node];
      grid.value[node] = 0.25F * (left + right + below + above);
    }
}

/// Fills the unknown nodes of `fine`; `coarse` is complete.
void push(const Grid& coarse, Grid& fine) {
  std::vector<std::size_t> unknown;
  for (int j = 0; j < fine.ny; ++j)
    for (int i = 0; i < fine.nx; ++i) {
      const std::size_t node = fine.index(i, j);
      if (fine.known[node] != 0) continue;
      fine.value[node] = interpolate(coarse, i, j);
      unknown.push_back(node);
    }
  relax(fine, unknown);
}

}  // namespace

void continue_heights(std::vector<float>& height_m, int nx, int ny) {
  Grid finest(nx, ny);
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t node = 0; node < height_m.size(); ++node)
    if (std::isfinite(height_m[node])) lowest = std::min(lowest, static_cast<double>(height_m[node]));
  if (!std::isfinite(lowest)) {
    std::fill(height_m.begin(), height_m.end(), 0.0F);
    return;
  }
  bool complete = true;
  for (std::size_t node = 0; node < height_m.size(); ++node) {
    const bool known = std::isfinite(height_m[node]);
    finest.known[node] = known ? 1 : 0;
    finest.value[node] = known ? height_m[node] : 0.0F;
    complete = complete && known;
  }
  if (complete) return;

  std::vector<Grid> levels;
  levels.push_back(std::move(finest));
  while (levels.back().nx > 1 || levels.back().ny > 1) {
    const Grid& last = levels.back();
    if (std::find(last.known.begin(), last.known.end(), std::uint8_t{0}) == last.known.end()) break;
    levels.push_back(pull(last));
  }
  for (std::size_t level = levels.size() - 1; level-- > 0;) push(levels[level + 1], levels[level]);
  height_m = std::move(levels.front().value);
}

}  // namespace sparsha::scene
