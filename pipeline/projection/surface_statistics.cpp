// Blocks of columns chosen by a hash hold whole neighbourhoods; quadrics through these tell form from noise.
#include "pipeline/projection/surface_statistics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "base/statistics.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/surface_plane.h"

namespace sparsha::pipeline {
namespace {

constexpr double kBlockSpacings = 16.0;  // side of a block
constexpr double kInner = 0.2;           // neighbourhoods are centred this near to its middle, sides
constexpr double kBlocks = 128.0;
constexpr std::size_t kSeeds = 16;     // neighbourhoods of a block
constexpr std::size_t kForNoise = 24;  // points of a neighbourhood
constexpr std::size_t kForSpacing = 14;
constexpr std::size_t kMostOfBlock = 20000;
// Form and second layers only ever add to a residual, so a low quantile is nearest to the noise. It is divided by that
// quantile of sqrt(chi^2 / 18), 18 = 24 points less 6 coefficients.
constexpr double kQuantile = 0.35;
constexpr double kOfChi = 0.915;
// A neighbourhood of 14 points is flat up to this noise, spacings.
constexpr double kFlat = 0.6;
constexpr std::size_t kMostScale = 8;
constexpr std::size_t kPiece = 1U << 15U;
constexpr std::size_t kBatch = 1U << 10U;

struct Drawn {
  std::uint64_t block;
  SpacePoint point;
  bool inner;
};

bool before(const Drawn& a, const Drawn& b) {
  return std::tie(a.block, a.point.z, a.point.x, a.point.y) < std::tie(b.block, b.point.z, b.point.x, b.point.y);
}

bool same(const Drawn& a, const Drawn& b) { return !before(a, b) && !before(b, a); }

std::uint64_t hash_point(const SpacePoint& p) {
  return hash_words(std::array<std::uint64_t, 3>{std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                                                 std::bit_cast<std::uint32_t>(p.z)});
}

// The points of blocks of `side_m`, sorted by block and place; each place once.
std::vector<Drawn> draw_blocks(const OrientedPieces& pieces, const Extent& extent, double side_m, ThreadPool& pool) {
  const double blocks = extent.covered_area_m2 / (side_m * side_m);
  BlockKernel kernel;
  kernel.x0_m = static_cast<float>(extent.xmin_m);
  kernel.y0_m = static_cast<float>(extent.ymin_m);
  kernel.per_m = static_cast<float>(1.0 / side_m);
  kernel.limit = static_cast<std::uint32_t>(std::min(1.0, kBlocks / std::max(1.0, blocks)) * 4294967295.0);
  std::vector<Drawn> drawn;
  pieces([&](const OrientedPoints& points) {
    std::vector<std::vector<Drawn>> parts((points.count + kPiece - 1) / kPiece);
    pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::array<std::uint32_t, kBatch> numbers;
      for (std::size_t first = begin; first < end; first += kBatch) {
        const std::size_t here = fastest_kernels().draw_blocks(kernel, points.x.get() + first, points.y.get() + first,
                                                               std::min(kBatch, end - first), numbers.data());
        for (std::size_t d = 0; d < here; ++d) {
          const std::size_t k = first + numbers[d];
          const float a = (points.x[k] - kernel.x0_m) * kernel.per_m;
          const float b = (points.y[k] - kernel.y0_m) * kernel.per_m;
          const auto i = static_cast<std::uint32_t>(a);
          const auto j = static_cast<std::uint32_t>(b);
          const float u = a - static_cast<float>(i) - 0.5F;
          const float v = b - static_cast<float>(j) - 0.5F;
          parts[begin / kPiece].push_back({(static_cast<std::uint64_t>(j) << 32U) | i,
                                           {points.x[k], points.y[k], points.z[k]},
                                           std::max(std::abs(u), std::abs(v)) < static_cast<float>(kInner)});
        }
      }
    });
    for (const std::vector<Drawn>& part : parts) drawn.insert(drawn.end(), part.begin(), part.end());
  });
  std::sort(drawn.begin(), drawn.end(), before);
  drawn.erase(std::unique(drawn.begin(), drawn.end(), same), drawn.end());
  return drawn;
}

struct Measured {
  std::vector<double> noise_m, spacing_m;
  std::size_t seeds = 0;

  void add(const Measured& other) {
    seeds += other.seeds;
    noise_m.insert(noise_m.end(), other.noise_m.begin(), other.noise_m.end());
    spacing_m.insert(spacing_m.end(), other.spacing_m.begin(), other.spacing_m.end());
  }
};

// Neighbourhoods of one block's points. Those that reach beyond the block are not used.
Measured measure_block(std::span<const Drawn> block, double margin_m, std::size_t per_neighbour) {
  std::vector<SpacePoint> points;
  std::vector<std::pair<std::uint64_t, std::size_t>> seeds;
  for (const Drawn& drawn : block) {
    if (drawn.inner) seeds.emplace_back(hash_point(drawn.point), points.size());
    points.push_back(drawn.point);
  }
  std::sort(seeds.begin(), seeds.end());
  seeds.resize(std::min(seeds.size(), kSeeds));
  Measured measured;
  measured.seeds = seeds.size();
  if (points.size() < kForNoise * per_neighbour) return measured;
  Neighbourhood near(points);
  for (const auto& [hash, seed] : seeds) {
    const std::size_t taken = near.take(seed, kForNoise * per_neighbour, margin_m);
    const std::size_t count = kForSpacing * per_neighbour;
    if (taken < count) continue;
    measured.spacing_m.push_back(near.radius_m(count) * std::sqrt(std::numbers::pi / static_cast<double>(count)));
    if (taken < kForNoise * per_neighbour) continue;
    const SurfacePlane plane = near.plane();
    if (!plane.planar()) continue;
    if (const std::optional<double> residual = near.residual_m(plane)) measured.noise_m.push_back(*residual);
  }
  return measured;
}

}  // namespace

SurfaceStatistics surface_statistics(const OrientedPieces& pieces, const Extent& extent, double spacing_m,
                                     ThreadPool& pool) {
  SurfaceStatistics result;
  for (std::size_t scale = 1;; scale *= 2) {
    const double side_m = kBlockSpacings * spacing_m * static_cast<double>(scale);
    const std::vector<Drawn> drawn = draw_blocks(pieces, extent, side_m, pool);
    std::vector<std::span<const Drawn>> blocks;
    for (std::size_t begin = 0, end = 0; begin < drawn.size(); begin = end) {
      while (end < drawn.size() && drawn[end].block == drawn[begin].block) ++end;
      blocks.emplace_back(drawn.data() + begin, std::min(end - begin, kMostOfBlock));
    }
    std::vector<Measured> parts(blocks.size());
    pool.for_ranges(blocks.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        parts[b] = measure_block(blocks[b], (0.5 - kInner) * side_m, scale * scale);
      }
    });
    Measured all;
    for (const Measured& part : parts) all.add(part);
    constexpr std::size_t kFew = 12;
    if (all.spacing_m.size() < kFew) return result;
    // The first scale says how dense the points are, the last how far they scatter.
    if (scale == 1) {
      result.spacing_m = quantile(all.spacing_m, 0.5);
      result.sparse_share = 1.0 - static_cast<double>(all.spacing_m.size()) / static_cast<double>(all.seeds);
    }
    if (2 * all.noise_m.size() >= all.spacing_m.size() && all.noise_m.size() >= kFew) {
      result.scale = scale;
      result.noise_m = quantile(all.noise_m, kQuantile) / kOfChi;
      if (result.noise_m <= kFlat * static_cast<double>(scale) * result.spacing_m) return result;
    }
    if (scale == kMostScale) return result;
  }
}

}  // namespace sparsha::pipeline
