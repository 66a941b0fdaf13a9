// Blocks of about 36 points; in each the front layer is found, fitted and counted.
#include "pipeline/grid/project_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pipeline/grid/project_fit.h"
#include "pipeline/grid/project_kernel.h"
#include "pipeline/grid/project_node.h"

namespace sparsha::pipeline {
namespace {

constexpr double kBlockSpacings = 6.0;
// The estimates of blocks of about 36 points scatter; this is how their quantile lies to the true value.
constexpr double kNoiseQuantile = 0.35;
constexpr double kNoiseOfQuantile = 1.08;
constexpr double kBlocks = 700.0;
constexpr std::size_t kPiece = 1U << 15U;
struct Sample {
  std::uint64_t block;
  NodePoint point;

  bool operator<(const Sample& other) const {
    if (block != other.block) return block < other.block;
    if (point.z != other.point.z) return point.z > other.point.z;
    if (point.u != other.point.u) return point.u < other.point.u;
    return point.v < other.point.v;
  }
};

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

}  // namespace

CloudStatistics sample_cloud(const OrientedPieces& pieces, const Extent& extent, ThreadPool& pool) {
  CloudStatistics result;
  const double count = static_cast<double>(std::max<std::uint64_t>(1, extent.supported));
  const double area = std::min(extent.covered_area_m2, std::max(extent.width_m() * extent.height_m(), 1e-30));
  const double mean_spacing = std::sqrt(std::max(area, 1e-30) / count);
  result.point_spacing_m = mean_spacing;
  if (extent.width_m() * extent.height_m() <= 0.0) {
    result.point_spacing_m = std::max(extent.width_m(), extent.height_m()) / count;
    return result;
  }

  const double side = kBlockSpacings * mean_spacing;
  const double blocks = area / (side * side);
  BlockKernel blocks_drawn;
  blocks_drawn.x0_m = static_cast<float>(extent.xmin_m);
  blocks_drawn.y0_m = static_cast<float>(extent.ymin_m);
  blocks_drawn.per_m = static_cast<float>(1.0 / side);
  blocks_drawn.limit = static_cast<std::uint32_t>(std::min(1.0, kBlocks / std::max(1.0, blocks)) * 4294967295.0);
  std::vector<Sample> samples;
  pieces([&](const OrientedPoints& points) {
    std::vector<std::vector<Sample>> parts((points.count + kPiece - 1) / kPiece);
    pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::vector<Sample>& mine = parts[begin / kPiece];
      std::vector<std::uint32_t> drawn(end - begin);
      drawn.resize(fastest_kernels().draw_blocks(blocks_drawn, points.x.get() + begin, points.y.get() + begin,
                                                 end - begin, drawn.data()));
      for (const std::uint32_t d : drawn) {
        const std::size_t k = begin + d;
        const float a = (points.x[k] - blocks_drawn.x0_m) * blocks_drawn.per_m;
        const float b = (points.y[k] - blocks_drawn.y0_m) * blocks_drawn.per_m;
        const auto i = static_cast<std::uint32_t>(a);
        const auto j = static_cast<std::uint32_t>(b);
        mine.push_back({(static_cast<std::uint64_t>(j) << 32U) | i,
                        {points.z[k], a - static_cast<float>(i) - 0.5F, b - static_cast<float>(j) - 0.5F}});
      }
    });
    for (const std::vector<Sample>& part : parts) samples.insert(samples.end(), part.begin(), part.end());
  });
  std::sort(samples.begin(), samples.end());
  // Scanners and merges deliver points twice; a point makes the surface no denser by being told again.
  const auto same = [](const Sample& a, const Sample& b) { return !(a < b) && !(b < a); };
  samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());
  std::vector<NodePoint> sorted(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) sorted[k] = samples[k].point;

  std::vector<double> scratch;
  // The gap needs the noise and the noise the gap: from no noise upwards, five rounds settle it.
  for (int round = 0; round < 5; ++round) {
    std::vector<Weighted> noises;
    std::vector<Weighted> spacings;
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
      while (end < samples.size() && samples[end].block == samples[begin].block) ++end;
      const std::span<const NodePoint> block(sorted.data() + begin, end - begin);
      const double block_spacing = side / std::sqrt(static_cast<double>(block.size()));
      const std::span<const NodePoint> front = front_layer(block, layer_gap_m(result.noise_m, block_spacing));
      if (front.empty()) continue;
      const auto weight = static_cast<double>(front.size());
      spacings.push_back({side / std::sqrt(weight), weight});
      const double noise = residual_scale_m(front, scratch);
      if (noise >= 0.0) noises.push_back({noise, weight});
    }
    // Form and mixed layers only ever add to the noise of a block: its lower quantile is what the scanner did.
    result.noise_m = kNoiseOfQuantile * weighted_quantile(noises, kNoiseQuantile, 0.0);
    result.point_spacing_m = weighted_quantile(spacings, 0.5, mean_spacing);
  }
  return result;
}

}  // namespace sparsha::pipeline
