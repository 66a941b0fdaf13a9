// Blocks of about 36 points; in each the front layer is found, fitted and counted.
#include "pipeline/projection/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/numbers/statistics.h"
#include "pipeline/projection/local_fit.h"
#include "pipeline/projection/node_fitter.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/surface_plane.h"

namespace sparsha::pipeline {
namespace {

constexpr double kBlockSpacings = 6.0;
// The estimates of blocks of about 36 points scatter; this is how their quantile lies to the true value.
constexpr double kNoiseQuantile = 0.35;
constexpr double kNoiseOfQuantile = 1.08;
constexpr double kBlocks = 700.0;
// Where the lines of a scanner are farther apart than the points on them, the nearest points often all lie on one line.
// Where many seem to, wider blocks tell whether they do.
constexpr double kSeem = 1.0 / 3.0;
constexpr double kDo = 0.2;  // at most 0.16 of the neighbourhoods of points that lie at random, as a lion's
constexpr double kUpright = 0.2;
constexpr double kWideTimes = 4.0;      // as wide as the other blocks,
constexpr double kWideSpacings = 20.0;  // and at least so many point spacings
constexpr std::size_t kPiece = 1U << 15U;
constexpr std::size_t kBatch = 1U << 10U;
constexpr std::size_t kBlocksAtOnce = 32;

struct Sample {
  std::uint64_t block;
  NodePoint point;
};

// An object, which std::sort calls without a pointer.
constexpr auto before = [](const NodePoint& a, const NodePoint& b) {
  if (a.z != b.z) return a.z > b.z;
  if (a.u != b.u) return a.u < b.u;
  return a.v < b.v;
};

// The points of one block, the highest first, and what the latest round made of its front.
struct Block {
  std::size_t begin = 0, end = 0;
  std::size_t front_begin = 0, front_size = 0;
  double noise_m = -1.0;
  bool deep = false;  // filled with points far deeper than it is wide: a floor or a wall that the view shows edge-on
};

// `sorted`: the highest first.
bool is_deep(std::span<const NodePoint> sorted, double side) {
  constexpr double kDeep = 6.0;    // sides: a slope of that holds no height field
  constexpr double kBreak = 0.25;  // of the depth: front and back with nothing between are no such thing
  if (sorted.size() < 10) return false;
  const std::span<const NodePoint> inner = sorted.subspan(sorted.size() / 10, sorted.size() - sorted.size() / 5);
  const auto depth = static_cast<double>(inner.front().z - inner.back().z);
  if (!(depth > kDeep * side)) return false;
  for (std::size_t k = 1; k < inner.size(); ++k)
    if (static_cast<double>(inner[k - 1].z - inner[k].z) > kBreak * depth) return false;
  return true;
}

// Gathers the samples of each block; the order of the blocks and of their points is that of the samples.
std::vector<Block> gather_blocks(const std::vector<Sample>& samples, std::vector<NodePoint>& points) {
  std::unordered_map<std::uint64_t, std::size_t> number;
  std::vector<std::size_t> of_sample(samples.size());
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    // Scan lines stay in a block for a while.
    const bool again = k > 0 && samples[k].block == samples[k - 1].block;
    of_sample[k] = again ? of_sample[k - 1] : number.try_emplace(samples[k].block, blocks.size()).first->second;
    if (of_sample[k] == blocks.size()) blocks.emplace_back();
    ++blocks[of_sample[k]].end;
  }
  std::size_t total = 0;
  for (Block& block : blocks) {
    block.begin = total;
    total += std::exchange(block.end, total);
  }
  points.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) points[blocks[of_sample[k]].end++] = samples[k].point;
  return blocks;
}

// The value that a share of the weight does not exceed.
struct Weighted {
  double value, weight;
};
double weighted_quantile(std::vector<Weighted>& values, double share, double otherwise) {
  double total = 0.0;
  for (const Weighted& v : values) total += v.weight;
  if (!(total > 0.0)) return otherwise;
  std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double below = 0.0;
  for (const Weighted& v : values) {
    below += v.weight;
    if (below >= share * total) return v.value;
  }
  return values.back().value;
}

// Which neighbourhoods of a block are looked at.
struct Look {
  double blocks = kBlocks;                                     // about
  std::size_t neighbours = 10;                                 // of a plane
  std::size_t most = std::numeric_limits<std::size_t>::max();  // of a block, about
  double thick = 1.5;                                          // of one layer with its noise, spacings
};
constexpr Look kWideLook{24.0, 40, 16};
constexpr double kFewestBlocks = 100.0;

// The area of neighbourhoods whose points are so far apart; stray points, which are farther from others than a sparse
// surface's, count as one of those.
double area_of(const std::vector<double>& spacings_m, double median_m) {
  constexpr double kSparsest = 4.0;  // medians
  double area_m2 = 0.0;
  for (const double spacing_m : spacings_m) {
    const double side_m = std::min(spacing_m, kSparsest * median_m);
    area_m2 += side_m * side_m;
  }
  return area_m2;
}

// Neighbourhoods about the middle of a block: how many are flat, and of these steep, and their point spacing.
struct Steepness {
  std::size_t flat = 0, steep = 0;
  std::size_t looked_at = 0, on_lines = 0;  // all, and those whose nearest points lie on one line
  std::vector<double> spacings_m, steep_spacings_m;
  double slope_x = 0.0, slope_y = 0.0;  // sums over those that are not steep,
  std::size_t sloped = 0;               // and their number
  std::size_t blocks = 0;               // with a flat neighbourhood,
  std::vector<double> apart_m;          // of these with another layer below the highest: the distance across the two

  [[nodiscard]] double on_lines_share() const {
    return static_cast<double>(on_lines) / static_cast<double>(std::max<std::size_t>(1, looked_at));
  }
  [[nodiscard]] SpaceStatistics statistics() {
    SpaceStatistics result;
    if (flat > 0) {
      result.steep_share = static_cast<double>(steep) / static_cast<double>(flat);
      result.surface_spacing_m = median(spacings_m);
      result.steep_area =
          area_of(steep_spacings_m, result.surface_spacing_m) / area_of(spacings_m, result.surface_spacing_m);
    }
    if (!apart_m.empty()) {
      result.layered_share = static_cast<double>(apart_m.size()) / static_cast<double>(blocks);
      result.layers_apart_m = median(apart_m);
      result.tilt = std::hypot(slope_x, slope_y) / static_cast<double>(sloped);
    }
    return result;
  }
};

// How a flat neighbourhood continues to the middle of its block.
struct Continued {
  double height_m;
  double upright;  // z of the normal
};

// The distance across from the highest layer to the next in the middle of a block; nothing where there is one alone.
// `thick_m`: what noise and bending make of one layer.
std::optional<double> next_layer_m(std::vector<Continued>& surfaces, double thick_m) {
  std::sort(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) { return a.height_m > b.height_m; });
  const auto across = [&](const Continued& c) { return (surfaces.front().height_m - c.height_m) * c.upright; };
  const auto next =
      std::find_if(surfaces.begin(), surfaces.end(), [&](const Continued& c) { return across(c) > thick_m; });
  const auto above = next - surfaces.begin();
  const auto below = surfaces.end() - next;
  // Each holds a quarter: strays and the few points behind a relief make no layer.
  if (4 * above < above + below || 4 * below < above + below) return std::nullopt;
  return across(*next);
}

// Whether the points taken, or the nearest of them, lie on one line.
bool on_line(const Neighbourhood& near, const SurfacePlane& plane, std::size_t taken) {
  constexpr std::array<std::size_t, 3> kOfLine{5, 10, 20};
  return (plane.narrow() && taken <= kOfLine.back()) ||
         std::any_of(kOfLine.begin(), kOfLine.end(),
                     [&](std::size_t count) { return count < taken && near.narrow(count); });
}

Steepness steepness_of_block(std::span<const NodePoint> block, double side, const Look& look) {
  constexpr float kMiddle = 0.17F;
  constexpr double kSteep = 0.5;  // z of a normal
  Steepness result;
  if (block.size() < look.neighbours) return result;
  std::vector<SpacePoint> points;
  std::vector<std::size_t> seeds;
  for (const NodePoint& p : block) {
    if (std::abs(p.u) < kMiddle && std::abs(p.v) < kMiddle) seeds.push_back(points.size());
    points.push_back({p.u * static_cast<float>(side), p.v * static_cast<float>(side), p.z});
  }
  Neighbourhood near(points);
  std::vector<Continued> surfaces;
  const std::size_t step = 1 + seeds.size() / look.most;
  for (std::size_t s = 0; s < seeds.size(); s += step) {
    const std::size_t k = seeds[s];
    constexpr double kAnyFar = std::numeric_limits<double>::infinity();
    near.take(k, look.neighbours, kAnyFar);
    SurfacePlane plane = near.plane();
    // The other face of a thin sheet may be as near.
    if (const std::optional<Sheet> face = near.sheet(plane)) {
      if (near.take(k, look.neighbours, kAnyFar, &*face) < look.neighbours) continue;
      plane = near.plane();
    }
    ++result.looked_at;
    result.on_lines += on_line(near, plane, look.neighbours) ? 1 : 0;
    if (!plane.planar()) continue;
    ++result.flat;
    const double radius_m = near.radius_m(look.neighbours);
    result.spacings_m.push_back(radius_m * std::sqrt(std::numbers::pi / static_cast<double>(look.neighbours)));
    if (plane.normal[2] < kSteep) {
      ++result.steep;
      result.steep_spacings_m.push_back(result.spacings_m.back());
    }
    const std::array<double, 3>& n = plane.normal;
    if (n[2] < kSteep) continue;
    const double rise = (n[0] * static_cast<double>(points[k].x) + n[1] * static_cast<double>(points[k].y)) / n[2];
    result.slope_x -= n[0] / n[2];
    result.slope_y -= n[1] / n[2];
    ++result.sloped;
    surfaces.push_back({static_cast<double>(points[k].z) + rise, n[2]});
  }
  if (surfaces.empty()) return result;
  result.blocks = 1;
  std::vector<double> spacings_m = result.spacings_m;
  if (const std::optional<double> apart_m = next_layer_m(surfaces, look.thick * median(spacings_m)))
    result.apart_m.push_back(*apart_m);
  return result;
}

// Highest run of points, linked in z by the gap, that has at least max(3, 1/12) of the block's points.
std::span<const NodePoint> front_layer(std::span<const NodePoint> sorted, double gap_m) {
  const std::size_t least = std::max<std::size_t>(3, (sorted.size() + 11) / 12);
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= sorted.size(); ++k) {
    if (k < sorted.size() && static_cast<double>(sorted[k - 1].z - sorted[k].z) <= gap_m) continue;
    if (k - begin >= least) return sorted.subspan(begin, k - begin);
    begin = k;
  }
  return {};
}

// The points of blocks chosen by their places, from all pieces in order.
std::vector<Sample> draw_samples(const OrientedPieces& pieces, const BlockKernel& blocks, ThreadPool& pool) {
  std::vector<Sample> samples;
  pieces([&](const OrientedPoints& points) {
    std::vector<std::vector<Sample>> parts((points.count + kPiece - 1) / kPiece);
    pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::vector<Sample>& mine = parts[begin / kPiece];
      std::array<std::uint32_t, kBatch> drawn;
      for (std::size_t first = begin; first < end; first += kBatch) {
        const std::size_t here = fastest_kernels().draw_blocks(blocks, points.x.get() + first, points.y.get() + first,
                                                               std::min(kBatch, end - first), drawn.data());
        for (std::size_t d = 0; d < here; ++d) {
          const std::size_t k = first + drawn[d];
          const float a = (points.x[k] - blocks.x0_m) * blocks.per_m;
          const float b = (points.y[k] - blocks.y0_m) * blocks.per_m;
          const auto i = static_cast<std::uint32_t>(a);
          const auto j = static_cast<std::uint32_t>(b);
          mine.push_back({(static_cast<std::uint64_t>(j) << 32U) | i,
                          {points.z[k], a - static_cast<float>(i) - 0.5F, b - static_cast<float>(j) - 0.5F}});
        }
      }
    });
    for (const std::vector<Sample>& part : parts) samples.insert(samples.end(), part.begin(), part.end());
  });
  pieces.join(samples);
  return samples;
}

// The blocks of a cloud, `side` long, and what they say of it.
class Blocks {
 public:
  Blocks(const std::vector<Sample>& samples, double side, ThreadPool& pool)
      : side_(side), pool_(&pool), found_(gather_blocks(samples, points_)) {
    sort_points();
  }

  [[nodiscard]] Steepness steepness(const Look& look) const {
    std::vector<Steepness> parts(found_.size());
    pool_->for_ranges(found_.size(), kBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) parts[b] = steepness_of_block(all_of(found_[b]), side_, look);
    });
    Steepness sum;
    for (const Steepness& part : parts) {
      sum.looked_at += part.looked_at;
      sum.on_lines += part.on_lines;
      sum.flat += part.flat;
      sum.steep += part.steep;
      sum.slope_x += part.slope_x;
      sum.slope_y += part.slope_y;
      sum.sloped += part.sloped;
      sum.blocks += part.blocks;
      sum.steep_spacings_m.insert(sum.steep_spacings_m.end(), part.steep_spacings_m.begin(),
                                  part.steep_spacings_m.end());
      sum.spacings_m.insert(sum.spacings_m.end(), part.spacings_m.begin(), part.spacings_m.end());
      sum.apart_m.insert(sum.apart_m.end(), part.apart_m.begin(), part.apart_m.end());
    }
    return sum;
  }

  // Where blocks that are deep hold most of the points, the side of those that hold about 36 points of the others; else
  // the side that there is.
  [[nodiscard]] double side_of_others() const {
    std::size_t deep = 0;
    std::size_t others = 0;
    std::size_t blocks = 0;
    for (const Block& block : found_) {
      (block.deep ? deep : others) += block.end - block.begin;
      blocks += block.deep ? 0 : 1;
    }
    if (deep <= others || others == 0) return side_;
    return kBlockSpacings * side_ * std::sqrt(static_cast<double>(blocks) / static_cast<double>(others));
  }

  // Takes the points of each block that lie in front where the noise is `noise_m`, and measures theirs.
  void find_fronts(double noise_m) {
    pool_->for_ranges(found_.size(), kBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
      std::vector<double> scratch;
      for (std::size_t b = begin; b < end; ++b) {
        Block& block = found_[b];
        const std::span<const NodePoint> all = all_of(block);
        const double block_spacing = side_ / std::sqrt(static_cast<double>(all.size()));
        const std::span<const NodePoint> front = front_layer(all, layer_gap_m(noise_m, block_spacing));
        const std::size_t front_begin = front.empty() ? 0 : static_cast<std::size_t>(front.data() - all.data());
        if (front_begin == block.front_begin && front.size() == block.front_size) continue;
        block.front_begin = front_begin;
        block.front_size = front.size();
        block.noise_m = residual_scale_m(front, scratch);
      }
    });
  }

  // Noise and spacing of the fronts.
  void measure_fronts(double mean_spacing, CloudStatistics& result) const {
    std::vector<Weighted> noises;
    std::vector<Weighted> spacings;
    for (const Block& block : found_) {
      if (block.front_size == 0 || (block.deep && !all_deep_)) continue;
      const auto weight = static_cast<double>(block.front_size);
      spacings.push_back({side_ / std::sqrt(weight), weight});
      if (block.noise_m >= 0.0) noises.push_back({block.noise_m, weight});
    }
    // Form and mixed layers only ever add to the noise of a block: its lower quantile is what the scanner did.
    result.noise_m = kNoiseOfQuantile * weighted_quantile(noises, kNoiseQuantile, 0.0);
    result.point_spacing_m = weighted_quantile(spacings, 0.5, mean_spacing);
  }

 private:
  [[nodiscard]] std::span<const NodePoint> all_of(const Block& block) const {
    return {points_.data() + block.begin, block.end - block.begin};
  }

  void sort_points() {
    pool_->for_ranges(found_.size(), kBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        const auto first = points_.begin() + static_cast<std::ptrdiff_t>(found_[b].begin);
        const auto last = points_.begin() + static_cast<std::ptrdiff_t>(found_[b].end);
        std::sort(first, last, before);
        // Scanners and merges deliver points twice; a point makes the surface no denser by being told again.
        const auto same = [](const NodePoint& p, const NodePoint& q) { return !before(p, q) && !before(q, p); };
        found_[b].end = found_[b].begin + static_cast<std::size_t>(std::unique(first, last, same) - first);
        found_[b].deep = is_deep(all_of(found_[b]), side_);
      }
    });
    all_deep_ = std::all_of(found_.begin(), found_.end(), [](const Block& block) { return block.deep; });
  }

  double side_;
  ThreadPool* pool_;
  bool all_deep_ = false;
  std::vector<NodePoint> points_;
  std::vector<Block> found_;
};

double area_of(const Extent& extent) {
  return std::min(extent.covered_area_m2, std::max(extent.width_m() * extent.height_m(), 1e-30));
}

Blocks blocks_of(const OrientedPieces& pieces, const Extent& extent, const Look& look, double side, ThreadPool& pool) {
  BlockKernel drawn;
  drawn.x0_m = static_cast<float>(extent.xmin_m);
  drawn.y0_m = static_cast<float>(extent.ymin_m);
  drawn.per_m = static_cast<float>(1.0 / side);
  const double share = std::min(1.0, look.blocks / std::max(1.0, area_of(extent) / (side * side)));
  drawn.limit = static_cast<std::uint32_t>(share * 4294967295.0);
  return {draw_samples(pieces, drawn, pool), side, pool};
}

}  // namespace

SpaceStatistics space_statistics(const OrientedPieces& pieces, const Extent& extent, double spacing_m,
                                 std::size_t scale, ThreadPool& pool) {
  constexpr std::size_t kSeeds = 16;
  constexpr double kThick = 3.0;  // times the scale: five standard deviations of the noise that asks for it
  const auto times = static_cast<double>(scale);
  const Look look{std::max(kFewestBlocks, kBlocks / (times * times)), Look{}.neighbours * scale * scale, kSeeds,
                  kThick * times};
  return blocks_of(pieces, extent, look, kBlockSpacings * times * spacing_m, pool).steepness(look).statistics();
}

CloudStatistics sample_cloud(const OrientedPieces& pieces, const Extent& extent, ThreadPool& pool) {
  CloudStatistics result;
  const double count = static_cast<double>(std::max<std::uint64_t>(1, extent.supported));
  const double area = area_of(extent);
  const double mean_spacing = std::sqrt(std::max(area, 1e-30) / count);
  result.point_spacing_m = mean_spacing;
  if (extent.width_m() * extent.height_m() <= 0.0) {
    result.point_spacing_m = std::max(extent.width_m(), extent.height_m()) / count;
    return result;
  }

  double side = kBlockSpacings * mean_spacing;
  Blocks blocks = blocks_of(pieces, extent, {}, side, pool);
  if (const double wider = blocks.side_of_others(); wider > side) {
    side = wider;
    blocks = blocks_of(pieces, extent, {}, side, pool);
  }

  Steepness near = blocks.steepness({});
  result.in_space = near.statistics();
  // Noise as wide as the points are apart makes a band of a line, which stands upright.
  if (near.on_lines_share() > kSeem || result.in_space.steep_share > kUpright) {
    const double wide = std::max(kWideTimes * side, kWideSpacings * result.in_space.surface_spacing_m);
    Steepness across = blocks_of(pieces, extent, kWideLook, wide, pool).steepness(kWideLook);
    if (across.on_lines_share() > kDo) result.on_lines = across.statistics();
  }
  // The gap needs the noise and the noise the gap: from no noise upwards, five rounds settle it.
  for (int round = 0; round < 5; ++round) {
    blocks.find_fronts(result.noise_m);
    blocks.measure_fronts(side / kBlockSpacings, result);
  }
  return result;
}

}  // namespace sparsha::pipeline
