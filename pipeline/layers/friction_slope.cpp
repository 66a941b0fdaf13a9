// From curvature to the slope c of law: curvature.
#include "pipeline/layers/friction_slope.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/numbers/statistics.h"
#include "pipeline/layers/layers.h"

namespace sparsha::pipeline {
namespace {

// The 95th percentile of k that noise leaves on a flat plane after its expectation is taken away, in noise floors, and
// the percentile from which on the texture stands clear of it.
constexpr double kNoisePercentile = 1.6;
constexpr double kClearPercentile = 3.0;
// Curvature of no texture, but of the rounding of a plane's heights.
constexpr double kRounding_per_m = 1e-9;

/// 1 where the four neighbours of a node, which has them, lie within `steep_m`.
void gentle_nodes(const float* z, std::size_t row_nodes, std::size_t begin, std::size_t end, float steep_m,
                  std::uint8_t* gentle) {
  const float* below = z - row_nodes;
  const float* above = z + row_nodes;
  for (std::size_t i = begin; i < end; ++i) {
    const int along = (std::abs(z[i] - z[i - 1]) <= steep_m ? 1 : 0) & (std::abs(z[i] - z[i + 1]) <= steep_m ? 1 : 0);
    const int across = (std::abs(z[i] - below[i]) <= steep_m ? 1 : 0) & (std::abs(z[i] - above[i]) <= steep_m ? 1 : 0);
    gentle[i] = static_cast<std::uint8_t>(along & across);
  }
}

/// The same for a node with links that are cut: its neighbours are those on its layer.
bool gentle_on_layer(const scene::DepthGrid& grid, const SurfaceLinks& links, int i, int j, float steep_m) {
  const std::vector<float>& z = grid.height_m;
  const std::size_t n = grid.lattice.index(i, j), row_nodes = static_cast<std::size_t>(grid.lattice.nx);
  const auto gentle = [&](std::uint64_t link, std::size_t other) {
    return (link & 1U) == 0 || std::abs(z[n] - z[other]) <= steep_m;
  };
  return gentle(links.right(i, j), n + 1) && gentle(links.right(i - 1, j), n - 1) &&
         gentle(links.up(i, j), n + row_nodes) && gentle(links.up(i, j - 1), n - row_nodes);
}

}  // namespace

double curvature_percentile(const scene::DepthGrid& grid, const std::vector<float>& k, const SurfaceLinks& links,
                            int radius, double steep_m) {
  const scene::Lattice& lattice = grid.lattice;
  const auto steep = static_cast<float>(steep_m);
  std::vector<float> values;
  values.reserve(lattice.count());
  std::vector<std::uint8_t> gentle(static_cast<std::size_t>(lattice.nx));
  std::vector<std::uint64_t> loose;
  for (const int margin : {std::max(radius, 1), 0}) {
    for (int j = margin; j < lattice.ny - margin; ++j) {
      const std::size_t row = lattice.index(0, j), end = static_cast<std::size_t>(std::max(lattice.nx - margin, 0));
      const auto first = static_cast<std::size_t>(margin);
      if (margin > 0) {
        gentle_nodes(grid.height_m.data() + row, static_cast<std::size_t>(lattice.nx), first, end, steep,
                     gentle.data());
        links.loose_nodes(j, loose);
        for (std::size_t w = 0; w < loose.size(); ++w)
          for (std::uint64_t nodes = loose[w]; nodes != 0; nodes &= nodes - 1) {
            const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(nodes));
            gentle[i] = gentle_on_layer(grid, links, static_cast<int>(i), j, steep) ? 1 : 0;
          }
      } else {
        for (int i = 0; i < lattice.nx; ++i)
          gentle[static_cast<std::size_t>(i)] = gentle_on_layer(grid, links, i, j, steep) ? 1 : 0;
      }
      for (std::size_t i = first; i < end; ++i)
        if (gentle[i] != 0 && grid.state[row + i] == scene::NodeState::measured && !std::isnan(k[row + i]))
          values.push_back(k[row + i]);
    }
    if (!values.empty()) return static_cast<double>(quantile(values, 0.95));
  }
  return 0;
}

double friction_slope(const CurvatureMap& map, const scene::FrictionConfig& config) {
  if (config.c_m) return *config.c_m;
  const double percentile = map.percentile_95_per_m;
  if (!(percentile > kRounding_per_m)) return 0;
  // Below the clear percentile the slope fades out, so that the roughness of a flat plane's noise is not felt.
  const double low = kNoisePercentile * map.noise_floor_per_m, high = kClearPercentile * map.noise_floor_per_m;
  const double t = high > low ? std::clamp((percentile - low) / (high - low), 0.0, 1.0) : 1.0;
  return t * t * (3 - 2 * t) * (config.mu_max - config.mu_0) / percentile;
}

}  // namespace sparsha::pipeline
