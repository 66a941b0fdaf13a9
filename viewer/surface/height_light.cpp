// Light on a height field. A shadow is swept row by row from the light's side: each row's shadow ceiling is the higher
// of ground and ceiling one row before, shifted by the light's direction and lowered by its slope.
#include "viewer/surface/height_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace sparsha::viewer {
namespace {

std::size_t size_of(int nx, int ny) { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }

Heights transposed(const Heights& heights) {
  Heights result{heights.ny, heights.nx, std::vector<float>(heights.value.size())};
  constexpr int kTile = 32;  // both arrays stay in cache
  for (int j0 = 0; j0 < heights.ny; j0 += kTile)
    for (int i0 = 0; i0 < heights.nx; i0 += kTile)
      for (int j = j0; j < std::min(j0 + kTile, heights.ny); ++j)
        for (int i = i0; i < std::min(i0 + kTile, heights.nx); ++i)
          result.value[size_of(i, heights.ny) + static_cast<std::size_t>(j)] =
              heights.value[size_of(j, heights.nx) + static_cast<std::size_t>(i)];
  return result;
}

/// Rows are swept in the direction away from the light; `shift` is how far, in columns, the light's source lies
/// sideways per row (|shift| <= 1), `fall` how much the ceiling drops per row.
void sweep(const Heights& heights, bool upwards, float shift, float fall, float softness, std::span<float> share) {
  const int nx = heights.nx;
  std::vector<float> ceiling(static_cast<std::size_t>(nx) + 2, -1e30F);
  std::vector<float> next(static_cast<std::size_t>(nx) + 2, -1e30F);
  const float inverse_softness = 1.0F / softness;
  // The source position is column i + shift of the row before: between columns i + low and i + low + 1.
  const int low = shift < 0.0F ? -1 : 0;
  const float weight = shift - static_cast<float>(low);
  for (int step = 0; step < heights.ny; ++step) {
    const int j = upwards ? step : heights.ny - 1 - step;
    const float* row = heights.value.data() + size_of(j, nx);
    float* out = share.data() + size_of(j, nx);
    float* after = next.data() + 1;
    const float* before = ceiling.data() + 1 + low;
    for (int i = 0; i < nx; ++i) {
      const float c = before[i] + weight * (before[i + 1] - before[i]) - fall;
      const float lit = 1.0F - (c - row[i]) * inverse_softness;
      out[i] = std::min(1.0F, std::max(0.0F, lit));
      after[i] = std::max(c, row[i]);
    }
    // Outside the lattice nothing casts a shadow; repeating the border keeps interpolation from fading it.
    next.front() = next[1];
    next.back() = next[static_cast<std::size_t>(nx)];
    std::swap(ceiling, next);
  }
}

struct Direction {
  double azimuth;
  double elevation;
  float weight;
};

/// Weighted sum of visibilities over directions; four fixed groups, so that the result does not depend on threads.
std::vector<float> gather(const Heights& heights, const std::vector<Direction>& directions, double softness,
                          ThreadPool& pool) {
  constexpr std::size_t kGroups = 4;
  std::vector<std::vector<float>> sums(kGroups);
  pool.for_ranges(kGroups, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group) {
      sums[group].assign(heights.value.size(), 0.0F);
      for (std::size_t d = group; d < directions.size(); d += kGroups) {
        const std::vector<float> share =
            light_visibility(heights, directions[d].azimuth, directions[d].elevation, softness);
        const float weight = directions[d].weight;
        for (std::size_t k = 0; k < share.size(); ++k) sums[group][k] += weight * share[k];
      }
    }
  });
  for (std::size_t group = 1; group < kGroups; ++group)
    for (std::size_t k = 0; k < sums[0].size(); ++k) sums[0][k] += sums[group][k];
  return std::move(sums[0]);
}

/// One pass of a running mean along rows of length nx.
void mean_rows(std::vector<float>& values, int nx, int ny, int radius) {
  std::vector<float> line(static_cast<std::size_t>(nx));
  const double share = 1.0 / (2 * radius + 1);
  for (int j = 0; j < ny; ++j) {
    float* row = values.data() + size_of(j, nx);
    double sum = 0.0;
    for (int i = -radius; i <= radius; ++i) sum += row[std::clamp(i, 0, nx - 1)];
    for (int i = 0; i < nx; ++i) {
      line[static_cast<std::size_t>(i)] = static_cast<float>(sum * share);
      sum += row[std::min(i + radius + 1, nx - 1)] - row[std::max(i - radius, 0)];
    }
    std::copy(line.begin(), line.end(), row);
  }
}

}  // namespace

std::vector<float> light_visibility(const Heights& heights, double azimuth_rad, double elevation_rad, double softness) {
  const double dx = std::cos(azimuth_rad);
  const double dy = std::sin(azimuth_rad);
  const double slope = std::tan(elevation_rad);
  std::vector<float> share(heights.value.size());
  if (std::abs(dy) >= std::abs(dx)) {
    // One row further costs 1 / |dy| spacings of horizontal distance.
    sweep(heights, dy < 0.0, static_cast<float>(dx / std::abs(dy)), static_cast<float>(slope / std::abs(dy)),
          static_cast<float>(softness), share);
    return share;
  }
  const Heights turned = transposed(heights);
  Heights result{turned.nx, turned.ny, std::vector<float>(share.size())};
  sweep(turned, dx < 0.0, static_cast<float>(dy / std::abs(dx)), static_cast<float>(slope / std::abs(dx)),
        static_cast<float>(softness), result.value);
  return transposed(result).value;
}

std::vector<float> soft_shadow(const Heights& heights, double azimuth_rad, double elevation_rad, double half_width_rad,
                               ThreadPool& pool) {
  constexpr int kSamples = 5;
  std::vector<Direction> directions;
  for (int k = 0; k < kSamples; ++k) {
    const double offset = (2.0 * k / (kSamples - 1) - 1.0) * half_width_rad;
    directions.push_back({azimuth_rad + 0.5 * offset, std::max(0.01, elevation_rad + offset), 1.0F / kSamples});
  }
  return gather(heights, directions, 0.5, pool);
}

std::vector<float> sky_visibility(const Heights& heights, double exaggeration, ThreadPool& pool) {
  constexpr int kAzimuths = 12;
  constexpr int kRings = 4;
  std::vector<Direction> directions;
  double total = 0.0;
  for (int ring = 0; ring < kRings; ++ring) {
    // Rings of equal share of sin^2(elevation) are rings of equal cosine-weighted light.
    const double elevation = std::asin(std::sqrt((ring + 0.5) / kRings));
    for (int k = 0; k < kAzimuths; ++k) {
      const double azimuth = 2.0 * std::numbers::pi * (k + (ring % 2 == 0 ? 0.25 : 0.75)) / kAzimuths;
      directions.push_back({azimuth, std::atan(std::tan(elevation) / exaggeration), 1.0F});
      total += 1.0;
    }
  }
  for (Direction& direction : directions) direction.weight = static_cast<float>(1.0 / total);
  return gather(heights, directions, 0.75 / exaggeration, pool);
}

std::vector<float> blur(const Heights& heights, int radius) {
  if (radius < 1) return heights.value;
  Heights work = heights;
  for (int pass = 0; pass < 2; ++pass) mean_rows(work.value, work.nx, work.ny, radius);
  Heights turned = transposed(work);
  for (int pass = 0; pass < 2; ++pass) mean_rows(turned.value, turned.nx, turned.ny, radius);
  return transposed(turned).value;
}

}  // namespace sparsha::viewer
