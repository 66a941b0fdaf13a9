#include "scene/folder/repeated_read.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "scene/frame/unrolling.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

template <typename Value>
void copy_columns(const std::vector<Value>& from, int from_nx, int column, std::vector<Value>& to, int to_nx) {
  if (from.empty() || from_nx == 0) return;
  const std::size_t rows = from.size() / static_cast<std::size_t>(from_nx);
  for (std::size_t j = 0; j < rows; ++j) {
    const auto source = from.begin() + static_cast<std::ptrdiff_t>(j * static_cast<std::size_t>(from_nx));
    std::copy(source, source + from_nx,
              to.begin() + static_cast<std::ptrdiff_t>(j * static_cast<std::size_t>(to_nx)) + column);
  }
}

void copy_columns(const Layers& from, int column, Layers& to) {
  const int from_nx = from.grid.lattice.nx, to_nx = to.grid.lattice.nx;
  const auto copy = [&](const auto& values, auto& into) { copy_columns(values, from_nx, column, into, to_nx); };
  copy(from.grid.height_m, to.grid.height_m);
  copy(from.grid.state, to.grid.state);
  copy(from.envelope_m, to.envelope_m);
  copy(from.curvature_per_m, to.curvature_per_m);
  copy(from.mean_curvature_per_m, to.mean_curvature_per_m);
  copy(from.gaussian_curvature_per_m2, to.gaussian_curvature_per_m2);
  copy(from.colour_rgba, to.colour_rgba);
  copy(from.intensity, to.intensity);
}

}  // namespace

int nodes_around(const SceneDescription& scene, int level) {
  const std::optional<UnrollConfig>& unroll = scene.config.unroll;
  if (!unroll || unroll->shape != UnrollConfig::Shape::cylinder) return 0;
  const Lattice& lattice = scene.levels.at(static_cast<std::size_t>(level));
  const double nodes = Unrolling(*unroll, scene.config.orientation.scan_to_grid).period_m() / lattice.spacing_m;
  constexpr double kWhole = 1e-6;
  const bool whole = nodes >= 1.0 && nodes <= lattice.nx && std::abs(nodes - std::round(nodes)) < kWhole * nodes;
  return whole ? static_cast<int>(std::lround(nodes)) : 0;
}

Layers read_repeated(const Scene& scene, int level, int i0, int j0, int nx, int ny) {
  Layers layers = scene.read(level, i0, j0, nx, ny);
  const int around = nodes_around(scene.description(), level);
  const Lattice& lattice = scene.description().levels.at(static_cast<std::size_t>(level));
  if (around == 0 || (i0 >= 0 && i0 + nx <= lattice.nx)) return layers;
  const int first = (lattice.nx - around) / 2;  // of the columns that are repeated
  for (int i = i0; i < i0 + nx;) {
    const int column = first + ((i - first) % around + around) % around;
    const int count = std::min(i0 + nx - i, first + around - column);
    if (column != i) copy_columns(scene.read(level, column, j0, count, ny), i - i0, layers);
    i += count;
  }
  return layers;
}

}  // namespace sparsha::scene
