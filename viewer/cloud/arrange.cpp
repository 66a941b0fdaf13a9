// Points into blocks along a Morton curve, each block shuffled by a fixed generator.
#include <algorithm>
#include <cmath>

#include "viewer/cloud/bounds.h"
#include "viewer/cloud/point_view.h"

namespace sparsha::viewer {
namespace {

constexpr std::uint32_t kBlock = 8192;

/// Every third bit.
std::uint64_t spread(std::uint32_t value) {
  std::uint64_t x = value & 0xFFFFU;
  x = (x | x << 16U) & 0xFF0000FFULL;
  x = (x | x << 8U) & 0x00F00F00F00FULL;
  x = (x | x << 4U) & 0x0C30C30C30C3ULL;
  return (x | x << 2U) & 0x249249249249ULL;
}

template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.size() != order.size()) {
    values.clear();
    return;
  }
  std::vector<T> sorted(values.size());
  for (std::size_t n = 0; n < order.size(); ++n) sorted[n] = values[order[n]];
  values.swap(sorted);
}

/// Area of a surface through N points is about N spacings squared; cells along the curve that hold points tell it.
double spacing_of(const std::vector<std::uint64_t>& sorted, double side_m) {
  if (sorted.size() < 2) return 0.0;
  // A surface that crosses a lattice meets about 1.5 cells for each cell's face of its area.
  constexpr double kCrossed = 1.5;
  constexpr std::size_t kPointsACell = 8;
  for (unsigned bits = 12; bits > 0; --bits) {
    const unsigned drop = 3 * (16 - bits);
    std::size_t cells = 1;
    for (std::size_t n = 1; n < sorted.size(); ++n) cells += sorted[n] >> drop != sorted[n - 1] >> drop ? 1 : 0;
    if (cells * kPointsACell > sorted.size()) continue;
    const double cell_m = side_m / static_cast<double>(1U << bits);
    return cell_m * std::sqrt(static_cast<double>(cells) / (kCrossed * static_cast<double>(sorted.size())));
  }
  return side_m / std::sqrt(static_cast<double>(sorted.size()));
}

/// Takes away what has no place.
void keep_finite(PointView& view) {
  const auto finite = [](const Eigen::Vector3f& p) { return p.allFinite(); };
  if (std::ranges::all_of(view.points, finite)) return;
  std::vector<std::uint32_t> kept;
  for (std::size_t n = 0; n < view.points.size(); ++n)
    if (finite(view.points[n])) kept.push_back(static_cast<std::uint32_t>(n));
  const std::size_t count = view.points.size();
  const auto pick = [&](auto& values) {
    if (values.size() != count) return;
    for (std::size_t n = 0; n < kept.size(); ++n) values[n] = values[kept[n]];
    values.resize(kept.size());
  };
  pick(view.rgba);
  pick(view.intensity);
  pick(view.station);
  pick(view.points);
}

}  // namespace

void arrange(PointView& view) {
  keep_finite(view);
  const std::size_t count = view.points.size();
  view.blocks.clear();
  view.spacing_m = 0.0;
  if (count == 0) return;
  const Bounds bounds = bounds_of(view.points);
  view.low = bounds.low;
  view.high = bounds.high;
  const double side_m = std::max<double>((view.high - view.low).maxCoeff(), 1e-9);

  // 16 bits an axis.
  std::vector<std::uint64_t> codes(count);
  std::vector<std::uint32_t> order(count);
  const float cells = static_cast<float>(65535.0 / side_m);
  for (std::size_t n = 0; n < count; ++n) {
    const Eigen::Vector3f cell = ((view.points[n] - view.low) * cells).cwiseMax(0.0F).cwiseMin(65535.0F);
    codes[n] = spread(static_cast<std::uint32_t>(cell.x())) | spread(static_cast<std::uint32_t>(cell.y())) << 1U |
               spread(static_cast<std::uint32_t>(cell.z())) << 2U;
    order[n] = static_cast<std::uint32_t>(n);
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return codes[a] != codes[b] ? codes[a] < codes[b] : a < b; });
  std::vector<std::uint64_t> sorted(count);
  for (std::size_t n = 0; n < count; ++n) sorted[n] = codes[order[n]];
  view.spacing_m = spacing_of(sorted, side_m);

  std::uint64_t seed = 0x9E3779B97F4A7C15ULL;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t size = std::min<std::size_t>(kBlock, count - begin);
    for (std::size_t k = size - 1; k > 0; --k) {
      seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
      std::swap(order[begin + k], order[begin + (seed >> 33U) % (k + 1)]);
    }
    PointBlock block;
    block.begin = static_cast<std::uint32_t>(begin);
    block.count = static_cast<std::uint32_t>(size);
    view.blocks.push_back(block);
  }
  reorder(view.points, order);
  reorder(view.rgba, order);
  reorder(view.intensity, order);
  reorder(view.station, order);
  for (PointBlock& block : view.blocks) {
    block.low = block.high = view.points[block.begin];
    for (std::uint32_t n = block.begin; n < block.begin + block.count; ++n) {
      block.low = block.low.cwiseMin(view.points[n]);
      block.high = block.high.cwiseMax(view.points[n]);
    }
  }
}

}  // namespace sparsha::viewer
