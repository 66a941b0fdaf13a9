// Heights to slopes, sky light, curvature tone and masks.
#include "viewer/surface/relief_data.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/statistics.h"
#include "scene/continuation.h"
#include "viewer/surface/height_light.h"

namespace sparsha::viewer {
namespace {

constexpr int kSkyNodes = 640;  // sky light is smooth: baked no finer than this along the longer side

std::uint8_t to_byte(double share) { return static_cast<std::uint8_t>(255.0 * std::clamp(share, 0.0, 1.0) + 0.5); }

/// Heights in spacings, as the light baker wants them.
Heights in_spacings(const ReliefData& relief) {
  Heights heights{relief.lattice.nx, relief.lattice.ny, relief.height_m};
  const auto scale = static_cast<float>(1.0 / relief.lattice.spacing_m);
  for (float& h : heights.value) h *= scale;
  return heights;
}

/// Means of blocks of `factor` x `factor` nodes, in spacings of the coarser lattice.
Heights reduced(const Heights& fine, int factor) {
  if (factor == 1) return fine;
  Heights coarse{(fine.nx + factor - 1) / factor, (fine.ny + factor - 1) / factor, {}};
  coarse.value.resize(static_cast<std::size_t>(coarse.nx) * static_cast<std::size_t>(coarse.ny));
  for (int j = 0; j < coarse.ny; ++j)
    for (int i = 0; i < coarse.nx; ++i) {
      float sum = 0.0F;
      int count = 0;
      for (int b = j * factor; b < std::min((j + 1) * factor, fine.ny); ++b)
        for (int a = i * factor; a < std::min((i + 1) * factor, fine.nx); ++a, ++count)
          sum +=
              fine.value[static_cast<std::size_t>(b) * static_cast<std::size_t>(fine.nx) + static_cast<std::size_t>(a)];
      coarse.value[static_cast<std::size_t>(j) * static_cast<std::size_t>(coarse.nx) + static_cast<std::size_t>(i)] =
          sum / static_cast<float>(count * factor);
    }
  return coarse;
}

/// A value of the coarse lattice at fine node (i, j), bilinear.
float sample(const std::vector<float>& coarse, int nx, int ny, int factor, int i, int j) {
  const float half = 0.5F * static_cast<float>(factor - 1);
  const float x =
      std::clamp((static_cast<float>(i) - half) / static_cast<float>(factor), 0.0F, static_cast<float>(nx - 1));
  const float y =
      std::clamp((static_cast<float>(j) - half) / static_cast<float>(factor), 0.0F, static_cast<float>(ny - 1));
  const int i0 = static_cast<int>(x), j0 = static_cast<int>(y);
  const int i1 = std::min(i0 + 1, nx - 1), j1 = std::min(j0 + 1, ny - 1);
  const float u = x - static_cast<float>(i0), v = y - static_cast<float>(j0);
  const auto at = [&](int a, int b) {
    return coarse[static_cast<std::size_t>(b) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(a)];
  };
  return (1 - v) * ((1 - u) * at(i0, j0) + u * at(i1, j0)) + v * ((1 - u) * at(i0, j1) + u * at(i1, j1));
}

void compute_slopes(ReliefData& relief, ThreadPool& pool) {
  const pipeline::Lattice& lattice = relief.lattice;
  relief.slope.resize(2 * lattice.count());
  const auto rows = static_cast<std::size_t>(lattice.ny);
  std::vector<double> squares(rows, 0.0);
  pool.for_ranges(rows, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int j = static_cast<int>(row);
      const int below = std::max(j - 1, 0), above = std::min(j + 1, lattice.ny - 1);
      for (int i = 0; i < lattice.nx; ++i) {
        const int left = std::max(i - 1, 0), right = std::min(i + 1, lattice.nx - 1);
        const auto step = [&](float rise, int nodes) {
          return nodes == 0 ? 0.0F : rise / (static_cast<float>(nodes) * static_cast<float>(lattice.spacing_m));
        };
        const std::size_t k = lattice.index(i, j);
        const float dx =
            step(relief.height_m[lattice.index(right, j)] - relief.height_m[lattice.index(left, j)], right - left);
        const float dy =
            step(relief.height_m[lattice.index(i, above)] - relief.height_m[lattice.index(i, below)], above - below);
        relief.slope[2 * k] = dx;
        relief.slope[2 * k + 1] = dy;
        // A cliff is one steep thing, not a rough surface.
        squares[row] += std::min(1.0, static_cast<double>(dx) * dx + static_cast<double>(dy) * dy);
      }
    }
  });
  double sum = 0.0;
  for (const double square : squares) sum += square;
  relief.rms_slope = std::sqrt(sum / static_cast<double>(lattice.count()));
}

/// 90th percentile of magnitudes, from about 4000 samples.
double typical(const std::vector<float>& values) {
  std::vector<float> some;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / 4096);
  for (std::size_t k = 0; k < values.size(); k += stride) some.push_back(std::abs(values[k]));
  return static_cast<double>(value_of_rank(some, some.size() * 9 / 10));
}

/// Heights above their surroundings at two scales: ridges positive, grooves negative, each scaled by what is typical.
std::vector<float> curvature_tone(const Heights& heights, double noise, ThreadPool& pool) {
  const int longer = std::max(heights.nx, heights.ny);
  const std::array<int, 2> radii{2, std::max(4, longer / 90)};
  std::array<std::vector<float>, 2> above;
  pool.for_ranges(2, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      above[s] = blur(heights, radii[s]);
      for (std::size_t k = 0; k < above[s].size(); ++k) above[s][k] = heights.value[k] - above[s][k];
    }
  });
  const double fine = std::max({typical(above[0]), 3.0 * noise, 1e-6});
  const double coarse = std::max({typical(above[1]), 3.0 * noise, 1e-6});
  std::vector<float> tone(heights.value.size());
  for (std::size_t k = 0; k < tone.size(); ++k) {
    const double x = 0.35 * above[0][k] / fine + 0.65 * above[1][k] / coarse;
    tone[k] = static_cast<float>(x / std::sqrt(1.0 + x * x));
  }
  return tone;
}

}  // namespace

double ReliefData::height_at(double x_m, double y_m) const {
  const double x = std::clamp((x_m - lattice.origin_m.x()) / lattice.spacing_m, 0.0, lattice.nx - 1.0);
  const double y = std::clamp((y_m - lattice.origin_m.y()) / lattice.spacing_m, 0.0, lattice.ny - 1.0);
  const int i = std::min(static_cast<int>(x), std::max(lattice.nx - 2, 0));
  const int j = std::min(static_cast<int>(y), std::max(lattice.ny - 2, 0));
  const int i1 = std::min(i + 1, lattice.nx - 1), j1 = std::min(j + 1, lattice.ny - 1);
  const double u = x - i, v = y - j;
  const auto at = [&](int a, int b) { return static_cast<double>(height_m[lattice.index(a, b)]); };
  return lattice.origin_m.z() + (1 - v) * ((1 - u) * at(i, j) + u * at(i1, j)) +
         v * ((1 - u) * at(i, j1) + u * at(i1, j1));
}

ReliefData prepare_relief(pipeline::Layers layers, int level, bool envelope, double noise_m, ThreadPool& pool) {
  ReliefData relief;
  relief.lattice = layers.grid.lattice;
  relief.level = level;
  relief.envelope = envelope && !layers.envelope_m.empty();
  relief.layers = std::move(layers);
  const std::vector<float>& source = relief.envelope ? relief.layers.envelope_m : relief.layers.grid.height_m;

  double low = 0.0, high = 0.0;
  bool known_any = false;
  for (const float h : source) {
    if (!std::isfinite(h)) continue;
    low = known_any ? std::min(low, static_cast<double>(h)) : h;
    high = known_any ? std::max(high, static_cast<double>(h)) : h;
    known_any = true;
  }
  relief.height_min_m = relief.lattice.origin_m.z() + low;
  relief.height_max_m = relief.lattice.origin_m.z() + high;

  relief.height_m = source;
  pipeline::continue_heights(relief.height_m, relief.lattice.nx, relief.lattice.ny);
  compute_slopes(relief, pool);

  const Heights heights = in_spacings(relief);
  const int factor = (std::max(heights.nx, heights.ny) + kSkyNodes - 1) / kSkyNodes;
  const Heights coarse = reduced(heights, factor);
  // Shallow relief is drawn in the sky's light as if it were deeper; the eye reads it as the same stone, better lit.
  const double exaggeration = std::clamp(0.45 / std::max(relief.rms_slope, 1e-9), 1.0, 4.0);
  const std::vector<float> sky = sky_visibility(coarse, exaggeration, pool);
  const std::vector<float> curvature = curvature_tone(heights, noise_m / relief.lattice.spacing_m, pool);

  relief.tone.resize(4 * relief.lattice.count());
  for (int j = 0; j < heights.ny; ++j)
    for (int i = 0; i < heights.nx; ++i) {
      const std::size_t k = relief.lattice.index(i, j);
      const bool finite = std::isfinite(source[k]);
      const pipeline::NodeState state = relief.layers.grid.state[k];
      const bool known = finite && state != pipeline::NodeState::unknown;
      const bool is_filled = known && state == pipeline::NodeState::filled;
      relief.any_filled = relief.any_filled || is_filled;
      relief.any_unknown = relief.any_unknown || !known;
      relief.tone[4 * k] = to_byte(factor == 1 ? sky[k] : sample(sky, coarse.nx, coarse.ny, factor, i, j));
      relief.tone[4 * k + 1] = to_byte(0.5 + 0.5 * curvature[k]);
      relief.tone[4 * k + 2] = known ? 255 : 0;
      relief.tone[4 * k + 3] = is_filled ? 255 : 0;
    }
  return relief;
}

std::vector<std::uint8_t> bake_shadow(const ReliefData& relief, const KeyLight& light, ThreadPool& pool) {
  const Heights heights = in_spacings(relief);
  const std::vector<float> share = soft_shadow(heights, light.azimuth_rad, light.elevation_rad, 0.09, pool);
  std::vector<std::uint8_t> bytes(share.size());
  for (std::size_t k = 0; k < share.size(); ++k) bytes[k] = to_byte(share[k]);
  return bytes;
}

int level_within(const pipeline::SceneDescription& description, int limit) {
  const int last = static_cast<int>(description.levels.size()) - 1;
  for (int level = 0; level < last; ++level) {
    const pipeline::Lattice& lattice = description.levels[static_cast<std::size_t>(level)];
    if (std::max(lattice.nx, lattice.ny) <= limit) return level;
  }
  return std::max(last, 0);
}

}  // namespace sparsha::viewer
