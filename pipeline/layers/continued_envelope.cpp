// On one side of a node the mean of a slope is not the node's height: the bilateral filter leaves a rim of false
// texture along every step and hole. Friction, which bends that rim once more, takes the envelope that the node's own
// layer would have if it went on.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "pipeline/layers/bilateral_kernel.h"
#include "pipeline/layers/layer_fit.h"
#include "pipeline/layers/layers.h"
#include "pipeline/layers/surface_links.h"

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 3.0;  // sigmas of space, as the filter's own
constexpr std::size_t kRowsPerPiece = 16;

/// Variances of second derivatives of a Gaussian-weighted quadratic fit, for a Gaussian of `scale` spacings that does
/// not end: 3 / (16 pi s^6) and 1 / (16 pi s^6).
NoiseGain whole_gain(double scale) {
  const double twist = 1 / (16 * M_PI * std::pow(scale, 6));
  return {3 * twist, 3 * twist, twist, twist};
}

bool any_loose(const SurfaceLinks& links, int rows) {
  std::vector<std::uint64_t> words;
  for (int j = 0; j < rows; ++j) {
    links.loose_nodes(j, words);
    if (std::any_of(words.begin(), words.end(), [](std::uint64_t word) { return word != 0; })) return true;
  }
  return false;
}

/// Nodes with a loose node within `reach` rows and columns.
class NearLoose {
 public:
  NearLoose(const SurfaceLinks& links, int nx, int ny, int reach) : links_(links), nx_(nx), ny_(ny), reach_(reach) {}

  void read(int j, std::vector<std::uint8_t>& near) {
    near.assign(static_cast<std::size_t>(nx_), 0);
    for (int row = std::max(0, j - reach_); row <= std::min(ny_ - 1, j + reach_); ++row) {
      links_.loose_nodes(row, words_);
      for (std::size_t w = 0; w < words_.size(); ++w)
        for (std::uint64_t nodes = words_[w]; nodes != 0; nodes &= nodes - 1) {
          const int i = static_cast<int>(64 * w) + std::countr_zero(nodes);
          std::fill(near.begin() + std::max(0, i - reach_), near.begin() + std::min(nx_, i + reach_ + 1),
                    std::uint8_t{1});
        }
    }
  }

 private:
  const SurfaceLinks& links_;
  int nx_, ny_, reach_;
  std::vector<std::uint64_t> words_;
};

}  // namespace

std::vector<float> continued_envelope(const scene::DepthGrid& grid, const std::vector<float>& envelope_m,
                                      const scene::TextureConfig& config, double noise_m, double step_m,
                                      ThreadPool& pool) {
  const scene::Lattice& lattice = grid.lattice;
  const double sigma = std::min(config.sigma_space_m / lattice.spacing_m, static_cast<double>(lattice.nx + lattice.ny));
  std::vector<float> result = envelope_m;
  if (kReach * sigma < 1) return result;
  const SurfaceLinks links(grid, {noise_m, step_m}, pool);
  if (!any_loose(links, lattice.ny)) return result;
  const OwnLayerFit layer_fit(sigma, lattice.spacing_m, whole_gain(sigma));
  const SurfaceLinks thinned = links.thinned(layer_fit.stride());
  const TextureView heights{grid.height_m.data(), nullptr, static_cast<std::size_t>(lattice.nx)};
  const int stride = layer_fit.stride(),
            reach = std::min(layer_fit.radius(), static_cast<int>(kReach * sigma / stride));
  const double range = 1 / (2 * config.sigma_range_m * config.sigma_range_m);

  pool.for_ranges(static_cast<std::size_t>(lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    OwnLayerFit fit = layer_fit;
    NearLoose near_loose(links, lattice.nx, lattice.ny, reach * stride);
    std::vector<std::uint8_t> near;
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j) {
      near_loose.read(j, near);
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t n = lattice.index(i, j);
        if (near[static_cast<std::size_t>(i)] == 0 || std::isnan(envelope_m[n])) continue;
        const std::optional<Quadratic> q = fit.quadratic(heights, thinned, i, j);
        if (!q) continue;
        double weighted = 0, weights = 1;
        for (int dy = -reach; dy <= reach; ++dy) {
          const std::uint64_t row = fit.window().row(dy) >> (fit.radius() - reach);
          const double v = dy * stride / sigma;
          for (int dx = -reach; dx <= reach; ++dx) {
            const double u = dx * stride / sigma;
            if (u * u + v * v > kReach * kReach || (dx == 0 && dy == 0)) continue;
            const bool own = ((row >> (dx + reach)) & 1U) != 0;
            const double difference =
                own ? static_cast<double>(grid.height_m[lattice.index(i + dx * stride, j + dy * stride)] -
                                          grid.height_m[n])
                    : (*q)[1] * u + (*q)[2] * v + (*q)[3] * u * u + (*q)[4] * u * v + (*q)[5] * v * v;
            const auto exponent = static_cast<float>(0.5 * (u * u + v * v) + range * difference * difference);
            const double weight = static_cast<double>(kernel::exp_minus(exponent));
            weighted += weight * difference;
            weights += weight;
          }
        }
        result[n] = static_cast<float>(static_cast<double>(grid.height_m[n]) + weighted / weights);
      }
    }
  });
  return result;
}

}  // namespace sparsha::pipeline
