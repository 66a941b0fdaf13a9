// Computes slopes, sky light, curvature tone and masks from heights.
#include "viewer/surface/relief_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/numbers/statistics.h"
#include "scene/ground/continuation.h"
#include "scene/scene.h"
#include "viewer/surface/height_light.h"

namespace sparsha::viewer {
namespace {

constexpr int kSkyNodes = 640;  // sky light is smooth: baked no finer than this along the longer side

std::uint8_t to_byte(double share) { return static_cast<std::uint8_t>(255.0 * std::clamp(share, 0.0, 1.0) + 0.5); }

/// Heights in spacings, as the curvature's tone wants them.
Heights in_spacings(const ReliefData& relief) {
  Heights heights{relief.lattice.nx, relief.lattice.ny, relief.height_m};
  const auto scale = static_cast<float>(1.0 / relief.lattice.spacing_m);
  for (float& h : heights.value) h *= scale;
  return heights;
}

/// The same for light: where nothing was measured there is nothing that could cast a shadow.
Heights lit_heights(const ReliefData& relief) {
  Heights heights = in_spacings(relief);
  if (!relief.any_unknown) return heights;
  const auto floor = static_cast<float>((relief.height_min_m - relief.lattice.origin_m.z()) / relief.lattice.spacing_m);
  for (std::size_t k = 0; k < heights.value.size(); ++k)
    if (relief.known[k] == 0) heights.value[k] = floor;
  return heights;
}

/// Means of the known nodes of blocks of `factor` x `factor`, in spacings of the coarser lattice.
Heights reduced(const Heights& fine, const std::vector<std::uint8_t>& known, int factor) {
  if (factor == 1) return fine;
  Heights coarse{(fine.nx + factor - 1) / factor, (fine.ny + factor - 1) / factor, {}};
  coarse.value.resize(static_cast<std::size_t>(coarse.nx) * static_cast<std::size_t>(coarse.ny));
  for (int j = 0; j < coarse.ny; ++j)
    for (int i = 0; i < coarse.nx; ++i) {
      float sum = 0.0F, lowest = 1e30F;
      int count = 0;
      for (int b = j * factor; b < std::min((j + 1) * factor, fine.ny); ++b)
        for (int a = i * factor; a < std::min((i + 1) * factor, fine.nx); ++a) {
          const std::size_t k =
              static_cast<std::size_t>(b) * static_cast<std::size_t>(fine.nx) + static_cast<std::size_t>(a);
          lowest = std::min(lowest, fine.value[k]);
          if (known[k] == 0) continue;
          sum += fine.value[k];
          ++count;
        }
      coarse.value[static_cast<std::size_t>(j) * static_cast<std::size_t>(coarse.nx) + static_cast<std::size_t>(i)] =
          (count > 0 ? sum / static_cast<float>(count) : lowest) / static_cast<float>(factor);
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

/// Slope along one axis: the mean of the steps to both neighbours that belong to the node's own surface.
float slope_of(const ReliefData& relief, std::size_t node, std::size_t stride, bool has_before, bool has_after,
               std::uint8_t step_bit) {
  const auto joined = [&](std::size_t low) {
    return (relief.joints.step[low] & step_bit) == 0 && relief.known[low] != 0 && relief.known[low + stride] != 0;
  };
  const bool before = has_before && joined(node - stride), after = has_after && joined(node);
  const float low = relief.height_m[before ? node - stride : node];
  const float high = relief.height_m[after ? node + stride : node];
  const int nodes = (before ? 1 : 0) + (after ? 1 : 0);
  return nodes == 0 ? 0.0F : (high - low) / (static_cast<float>(nodes) * static_cast<float>(relief.lattice.spacing_m));
}

/// Unknown nodes take the slope of a known neighbour, so that the rim is lit as the stone is.
void spread_slopes(ReliefData& relief, int i, int j) {
  const scene::Lattice& lattice = relief.lattice;
  const std::size_t node = lattice.index(i, j);
  float dx = 0.0F, dy = 0.0F;
  int count = 0;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, lattice.ny - 1); ++b)
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, lattice.nx - 1); ++a) {
      const std::size_t other = lattice.index(a, b);
      if (relief.known[other] == 0) continue;
      dx += relief.slope[2 * other];
      dy += relief.slope[2 * other + 1];
      ++count;
    }
  if (count == 0) return;
  relief.slope[2 * node] = dx / static_cast<float>(count);
  relief.slope[2 * node + 1] = dy / static_cast<float>(count);
}

void compute_slopes(ReliefData& relief, ThreadPool& pool) {
  const scene::Lattice& lattice = relief.lattice;
  relief.slope.resize(2 * lattice.count());
  const auto rows = static_cast<std::size_t>(lattice.ny), columns = static_cast<std::size_t>(lattice.nx);
  std::vector<double> squares(rows, 0.0);
  std::vector<std::size_t> counts(rows, 0);
  pool.for_ranges(rows, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int j = static_cast<int>(row);
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t k = lattice.index(i, j);
        if (relief.known[k] == 0) continue;
        const float dx = slope_of(relief, k, 1, i > 0, i + 1 < lattice.nx, Joints::kStepX);
        const float dy = slope_of(relief, k, columns, j > 0, j + 1 < lattice.ny, Joints::kStepY);
        relief.slope[2 * k] = dx;
        relief.slope[2 * k + 1] = dy;
        // A cliff is one steep thing, not a rough surface.
        squares[row] += std::min(1.0, static_cast<double>(dx) * dx + static_cast<double>(dy) * dy);
        ++counts[row];
      }
    }
  });
  double sum = 0.0;
  for (const double square : squares) sum += square;
  const std::size_t known = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  relief.rms_slope = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(known, 1)));
  if (!relief.any_unknown) return;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i)
      if (relief.known[lattice.index(i, j)] == 0) spread_slopes(relief, i, j);
}

/// Share of the border's nodes that are known.
double known_border(const ReliefData& relief) {
  const scene::Lattice& lattice = relief.lattice;
  std::size_t known = 0, all = 0;
  const auto look = [&](int i, int j) {
    ++all;
    known += relief.known[lattice.index(i, j)];
  };
  for (int i = 0; i < lattice.nx; ++i) {
    look(i, 0);
    look(i, lattice.ny - 1);
  }
  for (int j = 0; j < lattice.ny; ++j) {
    look(0, j);
    look(lattice.nx - 1, j);
  }
  return static_cast<double>(known) / static_cast<double>(std::max<std::size_t>(all, 1));
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

ReliefData prepare_relief(scene::Layers layers, int level, bool envelope, double noise_m, ThreadPool& pool) {
  ReliefData relief;
  relief.lattice = layers.grid.lattice;
  relief.level = level;
  relief.envelope = envelope && !layers.envelope_m.empty();
  relief.layers = std::move(layers);
  const std::vector<float>& source = relief.envelope ? relief.layers.envelope_m : relief.layers.grid.height_m;

  double low = 0.0, high = 0.0;
  bool known_any = false;
  relief.known.resize(source.size());
  for (std::size_t k = 0; k < source.size(); ++k) {
    const float h = source[k];
    relief.known[k] = std::isfinite(h) && relief.layers.grid.state[k] != scene::NodeState::unknown ? 1 : 0;
    relief.any_unknown = relief.any_unknown || relief.known[k] == 0;
    if (relief.known[k] == 0) continue;
    low = known_any ? std::min(low, static_cast<double>(h)) : h;
    high = known_any ? std::max(high, static_cast<double>(h)) : h;
    known_any = true;
  }
  relief.height_min_m = relief.lattice.origin_m.z() + low;
  relief.height_max_m = relief.lattice.origin_m.z() + high;

  relief.height_m = source;
  scene::continue_heights(relief.height_m, relief.lattice.nx, relief.lattice.ny);
  relief.joints =
      find_joints(relief.height_m, relief.known, relief.lattice.nx, relief.lattice.ny, relief.lattice.spacing_m);
  relief.border_known = known_border(relief);
  compute_slopes(relief, pool);

  const Heights heights = in_spacings(relief);
  const int factor = (std::max(heights.nx, heights.ny) + kSkyNodes - 1) / kSkyNodes;
  const Heights coarse = reduced(lit_heights(relief), relief.known, factor);
  // Shallow relief is drawn in the sky's light as if it were deeper; the eye reads it as the same stone, better lit.
  const double exaggeration = std::clamp(0.45 / std::max(relief.rms_slope, 1e-9), 1.0, 4.0);
  const std::vector<float> sky = sky_visibility(coarse, exaggeration, pool);
  const std::vector<float> curvature = curvature_tone(heights, noise_m / relief.lattice.spacing_m, pool);

  relief.tone.resize(4 * relief.lattice.count());
  for (int j = 0; j < heights.ny; ++j)
    for (int i = 0; i < heights.nx; ++i) {
      const std::size_t k = relief.lattice.index(i, j);
      const bool known = relief.known[k] != 0;
      const bool is_filled = known && relief.layers.grid.state[k] == scene::NodeState::filled;
      relief.any_filled = relief.any_filled || is_filled;
      relief.tone[4 * k] = to_byte(factor == 1 ? sky[k] : sample(sky, coarse.nx, coarse.ny, factor, i, j));
      relief.tone[4 * k + 1] = to_byte(0.5 + 0.5 * curvature[k]);
      relief.tone[4 * k + 2] = known ? 255 : 0;
      relief.tone[4 * k + 3] = is_filled ? 255 : 0;
    }
  return relief;
}

std::vector<std::uint8_t> bake_shadow(const ReliefData& relief, const KeyLight& light, ThreadPool& pool, bool soft) {
  const Heights heights = lit_heights(relief);
  constexpr double kHalfWidth_rad = 0.09, kEdge = 0.5;
  const std::vector<float> share =
      soft ? soft_shadow(heights, light.azimuth_rad, light.elevation_rad, kHalfWidth_rad, pool)
           : light_visibility(heights, light.azimuth_rad, light.elevation_rad, kEdge);
  std::vector<std::uint8_t> bytes(share.size());
  for (std::size_t k = 0; k < share.size(); ++k) bytes[k] = to_byte(share[k]);
  return bytes;
}

int level_within(const scene::SceneDescription& description, int limit) {
  const int last = static_cast<int>(description.levels.size()) - 1;
  for (int level = 0; level < last; ++level) {
    const scene::Lattice& lattice = description.levels[static_cast<std::size_t>(level)];
    if (std::max(lattice.nx, lattice.ny) <= limit) return level;
  }
  return std::max(last, 0);
}

}  // namespace sparsha::viewer
