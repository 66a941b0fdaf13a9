// Blocks of columns chosen by a hash hold whole neighbourhoods; quadrics through these tell form from noise.
#include "pipeline/projection/surface_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/numbers/statistics.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/steady.h"
#include "pipeline/projection/surface_plane.h"

namespace sparsha::pipeline {
namespace {

constexpr double kBlockSpacings = 16.0;  // side of a block,
constexpr double kOfLines = 24.0;        // and where points lie on lines
constexpr double kInner = 0.2;           // neighbourhoods are centred this near to its middle, sides
constexpr double kBlocks = 128.0;
constexpr std::size_t kSeeds = 16;     // neighbourhoods of a block
constexpr std::size_t kForNoise = 24;  // points of a neighbourhood
constexpr std::size_t kForSpacing = 14;
constexpr std::size_t kWidest = 4;  // times as many where these lie on one line
// So few points, itself among them, within 4.8 spacings of a point: it belongs to no surface, not to a sparse one.
constexpr std::size_t kScattered = 3;
constexpr std::size_t kMostOfBlock = 20000;
// Form and second layers only ever add to a residual, so a low quantile is nearest to the noise. It is divided by that
// quantile of sqrt(chi^2 / 18), 18 = 24 points less 6 coefficients.
constexpr double kQuantile = 0.35;
constexpr double kOfChi = 0.915;
// A neighbourhood of 14 points is flat up to this noise, spacings.
constexpr double kFlat = 0.6;
constexpr double kThin = 0.25;  // of points far apart that are a surface, spacings
constexpr std::size_t kMostScale = 8;
constexpr std::size_t kPiece = 1U << 15U;
constexpr std::size_t kBatch = 1U << 10U;

struct BlockPoint {
  SpacePoint place;
  bool inner;
};

struct Drawn {
  std::uint64_t block;
  BlockPoint point;
};

struct Block {
  std::uint64_t number;
  std::vector<BlockPoint> points;

  // By place, and each place once: the same for any order of the points.
  void put_in_order() {
    const auto key = [](const BlockPoint& p) { return std::tie(p.place.z, p.place.x, p.place.y); };
    std::sort(points.begin(), points.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
    points.erase(std::unique(points.begin(), points.end(), same), points.end());
    points.resize(std::min(points.size(), kMostOfBlock));
  }
};

// The points of each block, in any order; the blocks by their number.
class Blocks {
 public:
  void add(const std::vector<Drawn>& points) {
    std::size_t at = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::uint64_t number = points[k].block;
      // Scan lines stay in a block for a while.
      if (k == 0 || number != points[k - 1].block) at = number_.try_emplace(number, blocks_.size()).first->second;
      if (at == blocks_.size()) blocks_.push_back({number, {}});
      blocks_[at].points.push_back(points[k].point);
    }
  }
  /// Those of all processes.
  void join(const OrientedPieces& pieces) {
    if (!pieces.joins()) return;
    std::vector<Drawn> all;
    for (const Block& block : blocks_) {
      for (const BlockPoint& point : block.points) all.push_back({block.number, point});
    }
    pieces.join(all);
    *this = {};
    add(all);
  }
  [[nodiscard]] std::vector<Block> take() {
    std::sort(blocks_.begin(), blocks_.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
    return std::move(blocks_);
  }

 private:
  std::unordered_map<std::uint64_t, std::size_t> number_;
  std::vector<Block> blocks_;
};

// The points of blocks of `side_m` that a hash of their number chooses.
std::vector<Block> draw_blocks(const OrientedPieces& pieces, const Extent& extent, double side_m, ThreadPool& pool) {
  const double blocks = std::max(1.0, extent.covered_area_m2 / (side_m * side_m));
  BlockKernel kernel;
  kernel.x0_m = static_cast<float>(extent.xmin_m);
  kernel.y0_m = static_cast<float>(extent.ymin_m);
  kernel.per_m = static_cast<float>(1.0 / side_m);
  kernel.limit = static_cast<std::uint32_t>(std::min(1.0, kBlocks / steady(blocks)) * 4294967295.0);
  Blocks drawn;
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
                                           {{points.x[k], points.y[k], points.z[k]},
                                            std::max(std::abs(u), std::abs(v)) < static_cast<float>(kInner)}});
        }
      }
    });
    for (const std::vector<Drawn>& part : parts) drawn.add(part);
  });
  drawn.join(pieces);
  return drawn.take();
}

struct Measured {
  std::vector<double> noise_m, spacing_m, front_spacing_m, flat_spacing_m;
  std::size_t seeds = 0;

  void add(const Measured& other) {
    seeds += other.seeds;
    noise_m.insert(noise_m.end(), other.noise_m.begin(), other.noise_m.end());
    flat_spacing_m.insert(flat_spacing_m.end(), other.flat_spacing_m.begin(), other.flat_spacing_m.end());
    spacing_m.insert(spacing_m.end(), other.spacing_m.begin(), other.spacing_m.end());
    front_spacing_m.insert(front_spacing_m.end(), other.front_spacing_m.begin(), other.front_spacing_m.end());
  }
};

// The plane through the neighbourhood of a seed, and how many points that holds. Of a scanner's lines the nearest
// points often lie on one line, or in the plane of that line and the noise: more of them are taken then.
struct Patch {
  SurfacePlane plane;
  std::size_t count;
};
Patch widen(Neighbourhood& near, std::size_t seed, std::size_t wanted, double margin_m, bool on_lines) {
  constexpr double kTurned = 0.8;  // cosine of normals
  Patch patch{near.plane(), wanted};
  for (std::size_t more = 2 * wanted; patch.plane.narrow() && more <= kWidest * wanted; more *= 2) {
    if (near.take(seed, more, margin_m) < more) return patch;
    patch = {near.plane(), more};
  }
  if (!on_lines || patch.count == kWidest * wanted) return patch;
  const std::size_t before = patch.count;
  if (near.take(seed, kWidest * wanted, margin_m) < kWidest * wanted) return patch;
  const SurfacePlane wide = near.plane();
  const double cosine = std::inner_product(wide.normal.begin(), wide.normal.end(), patch.plane.normal.begin(), 0.0);
  if (std::abs(cosine) < kTurned) return {wide, kWidest * wanted};
  near.take(seed, before, margin_m);
  return patch;
}

// Whether another surface lies before the place.
bool is_hidden(const std::vector<SpacePoint>& points, const SpacePoint& place, double margin_m) {
  const auto beside = static_cast<float>(0.6 * margin_m);  // three spacings
  const auto before = static_cast<float>(2.0 * margin_m);  // ten
  return std::any_of(points.begin(), points.end(), [&](const SpacePoint& p) {
    return p.z > place.z + before && std::abs(p.x - place.x) < beside && std::abs(p.y - place.y) < beside;
  });
}

// Takes a seed's neighbours, those of its own face where a sheet is so thin that the other one is as near.
std::size_t take_own_face(Neighbourhood& near, std::size_t seed, std::size_t wanted, double margin_m, bool on_lines) {
  const std::size_t taken = near.take(seed, wanted, margin_m);
  if (on_lines || taken < kForSpacing) return taken;
  const std::optional<Sheet> face = near.sheet(near.plane());
  return face ? near.take(seed, wanted, margin_m, &*face) : taken;
}

// Neighbourhoods of one block's points. Those that reach beyond the block are not used.
Measured measure_block(const std::vector<BlockPoint>& block, double margin_m, std::size_t per_neighbour,
                       bool on_lines) {
  std::vector<SpacePoint> points;
  std::vector<std::size_t> inner;
  for (const BlockPoint& point : block) {
    if (point.inner) inner.push_back(points.size());
    points.push_back(point.place);
  }
  // Evenly among them as they are ordered, by height: a cloud that is moved a little keeps its seeds.
  std::vector<std::size_t> seeds;
  const std::size_t wanted_seeds = std::min(inner.size(), kSeeds);
  for (std::size_t s = 0; s < wanted_seeds; ++s) {
    seeds.push_back(inner[(2 * s + 1) * inner.size() / (2 * wanted_seeds)]);
  }
  Measured measured;
  measured.seeds = seeds.size();
  const std::size_t wanted = kForNoise * per_neighbour;
  if (points.size() < wanted) return measured;
  Neighbourhood near(points);
  for (const std::size_t seed : seeds) {
    const std::size_t taken = take_own_face(near, seed, wanted, margin_m, on_lines);
    std::size_t count = kForSpacing * per_neighbour;
    if (taken < kScattered) --measured.seeds;
    if (taken < count) continue;
    double radius_m = near.radius_m(count);
    std::optional<double> noise_m;
    if (taken == wanted) {
      const Patch patch = widen(near, seed, wanted, margin_m, on_lines);
      if (patch.count > wanted) {
        count = patch.count;
        radius_m = patch.plane.radius_m;
      }
      if (patch.plane.planar() && !(on_lines && patch.plane.narrow())) noise_m = near.residual_m(patch.plane);
    }
    measured.spacing_m.push_back(radius_m * std::sqrt(std::numbers::pi / static_cast<double>(count)));
    if (!is_hidden(points, points[seed], margin_m)) measured.front_spacing_m.push_back(measured.spacing_m.back());
    if (noise_m) measured.noise_m.push_back(*noise_m);
    if (noise_m && *noise_m <= kThin * measured.spacing_m.back()) {
      measured.flat_spacing_m.push_back(measured.spacing_m.back());
    }
  }
  return measured;
}

}  // namespace

SurfaceStatistics surface_statistics(const OrientedPieces& pieces, const Extent& extent, double spacing_m,
                                     bool on_lines, ThreadPool& pool, double sparse_m) {
  SurfaceStatistics result;
  for (std::size_t scale = 1;; scale *= 2) {
    const double side_m = (on_lines ? kOfLines : kBlockSpacings) * steady(spacing_m) * static_cast<double>(scale);
    std::vector<Block> blocks = draw_blocks(pieces, extent, side_m, pool);
    std::vector<Measured> parts(blocks.size());
    pool.for_ranges(blocks.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        blocks[b].put_in_order();
        parts[b] = measure_block(blocks[b].points, (0.5 - kInner) * side_m, scale * scale, on_lines);
      }
    });
    Measured all;
    for (const Measured& part : parts) all.add(part);
    constexpr std::size_t kFew = 12;
    if (all.spacing_m.size() < kFew) return result;
    // The first scale says how dense the points are, the last how far they scatter.
    if (scale == 1) {
      result.spacing_m = quantile(all.spacing_m, 0.5);
      const bool enough = all.front_spacing_m.size() >= kFew;
      result.front_spacing_m = enough ? quantile(all.front_spacing_m, 0.5) : result.spacing_m;
      const auto share_of_sparse = [&](const std::vector<double>& apart_m) {
        const auto sparse = std::count_if(apart_m.begin(), apart_m.end(), [&](double s) { return s > sparse_m; });
        return static_cast<double>(sparse) / static_cast<double>(all.seeds);
      };
      result.sparse_flat_share = share_of_sparse(all.flat_spacing_m);
      result.sparse_share = 1.0 - static_cast<double>(all.spacing_m.size()) / static_cast<double>(all.seeds);
    }
    if (2 * all.noise_m.size() >= all.spacing_m.size() && all.noise_m.size() >= kFew) {
      result.flat = true;
      result.noise_m = quantile(all.noise_m, kQuantile) / kOfChi;
      // Wide neighbourhoods may tell the faces of a thin sheet apart that narrow ones took for noise; discs need not be
      // as wide.
      const double noise_spacings = result.noise_m / result.spacing_m;
      for (result.scale = 1; result.scale < scale && noise_spacings > kFlat * static_cast<double>(result.scale);) {
        result.scale *= 2;
      }
      if (noise_spacings <= kFlat * static_cast<double>(scale)) return result;
    }
    if (scale == kMostScale) return result;
  }
}

}  // namespace sparsha::pipeline
