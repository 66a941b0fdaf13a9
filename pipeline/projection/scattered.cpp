// Counts points in cubes of space; chance is told from surfaces by how few the cubes about a point hold.
#include "pipeline/projection/scattered.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "base/numbers/hash.h"
#include "base/numbers/key_table.h"
#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/steady.h"

namespace sparsha::pipeline {
namespace {

constexpr int kBlockCubes = 12;        // side of a block of columns that is looked at
constexpr double kSampled = 50e3;      // points in such blocks, about
constexpr std::uint32_t kFew = 2;      // points in 27 cubes that stand alone
constexpr std::uint64_t kLeast = 30;   // points alone that say something,
constexpr double kLeastShare = 0.004;  // and their share
constexpr std::uint64_t kDense = 20;   // points in nine columns that make a surface
constexpr double kSigmas = 3.0;
constexpr double kMost = 8.0;
constexpr std::size_t kBatch = 1024;

using Cube = std::array<std::int64_t, 3>;
struct CubeHash {
  std::uint64_t operator()(const Cube& cube) const { return hash_cell(cube); }
};
struct Counted {
  Cube key{};
  std::uint32_t count = 0;
  bool inner = false;
};
using Cubes = KeyTable<Counted, CubeHash>;

std::uint32_t count_at(const Cubes& cubes, const Cube& key) {
  const std::uint32_t found = cubes.find(key);
  return found == cubes.size() ? 0U : cubes[found].count;
}

/// Points in the cubes about one; more than `enough` need not be counted.
std::uint32_t count_around(const Cubes& cubes, const Cube& key, std::uint32_t enough) {
  std::uint32_t sum = count_at(cubes, key);
  for (std::int64_t z = -1; z <= 1; ++z) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t x = -1; x <= 1; ++x) {
        if (sum > enough) return sum;
        if (x != 0 || y != 0 || z != 0) sum += count_at(cubes, {key[0] + x, key[1] + y, key[2] + z});
      }
    }
  }
  return sum;
}

/// Which cube a place lies in.
class CubeGrid {
 public:
  explicit CubeGrid(const ScatterRule& rule) : corner_m_(rule.corner_m), per_cube_(1.0 / rule.cube_m) {}

  /// False where the coordinate is no number, or too far away to be counted.
  bool along(std::size_t axis, float value_m, std::int64_t& cube) const {
    const double at = std::floor((static_cast<double>(value_m) - corner_m_[axis]) * per_cube_);
    if (!(std::abs(at) < 1e15)) return false;
    cube = static_cast<std::int64_t>(at);
    return true;
  }

 private:
  std::array<double, 3> corner_m_;
  double per_cube_;
};

/// The cubes of all processes, with their points together.
Cubes joined(const OrientedPieces& pieces, const Cubes& own) {
  std::vector<Counted> all;
  for (std::uint32_t c = 0; c < own.size(); ++c) all.push_back(own[c]);
  pieces.join(all);
  Cubes cubes;
  for (const Counted& found : all) {
    Counted& cube = cubes[cubes.number(found.key)];
    cube.count += found.count;
    cube.inner = found.inner;
  }
  return cubes;
}

/// The cubes of some blocks of columns, as large as it takes for about kSampled points.
Cubes sample_cubes(const OrientedPieces& pieces, const Extent& extent, const ScatterRule& rule) {
  const double side_m = kBlockCubes * rule.cube_m;
  const double points = static_cast<double>(std::max<std::uint64_t>(1, extent.supported));
  BlockKernel kernel;
  kernel.x0_m = static_cast<float>(extent.xmin_m);
  kernel.y0_m = static_cast<float>(extent.ymin_m);
  kernel.per_m = static_cast<float>(1.0 / side_m);
  kernel.limit = static_cast<std::uint32_t>(std::min(1.0, kSampled / steady(points)) * 4294967295.0);
  const CubeGrid grid(rule);
  Cubes cubes;
  std::array<std::uint32_t, kBatch> numbers;
  pieces([&](const OrientedPoints& piece) {
    for (std::size_t first = 0; first < piece.count; first += kBatch) {
      const std::size_t here = fastest_kernels().draw_blocks(kernel, piece.x.get() + first, piece.y.get() + first,
                                                             std::min(kBatch, piece.count - first), numbers.data());
      for (std::size_t d = 0; d < here; ++d) {
        const std::size_t k = first + numbers[d];
        // As the kernel does, so that a point's cube lies in its block.
        const float a = (piece.x[k] - kernel.x0_m) * kernel.per_m;
        const float b = (piece.y[k] - kernel.y0_m) * kernel.per_m;
        const auto i = static_cast<std::int64_t>(a);
        const auto j = static_cast<std::int64_t>(b);
        const auto u = std::min<std::int64_t>(kBlockCubes - 1,
                                              static_cast<std::int64_t>((a - static_cast<float>(i)) * kBlockCubes));
        const auto v = std::min<std::int64_t>(kBlockCubes - 1,
                                              static_cast<std::int64_t>((b - static_cast<float>(j)) * kBlockCubes));
        std::int64_t w = 0;
        if (!grid.along(2, piece.z[k], w)) continue;
        Counted& cube = cubes[cubes.number({i * kBlockCubes + u, j * kBlockCubes + v, w})];
        ++cube.count;
        cube.inner = std::min(u, v) > 0 && std::max(u, v) < kBlockCubes - 1;
      }
    }
  });
  if (pieces.joins()) return joined(pieces, cubes);
  return cubes;
}

}  // namespace

int ScatterRule::bins_needed(double node_spacing_m) const {
  return most == 0 ? 0 : static_cast<int>(std::ceil(2.0 * cube_m / node_spacing_m)) + 1;
}

ScatterRule find_scatter(const OrientedPieces& pieces, const PointTotals& totals, const Extent& extent,
                         double spacing_m) {
  ScatterRule rule;
  if (!(spacing_m > 0.0)) return rule;
  rule.cube_m = ScatterRule::kCubeSpacings * steady(spacing_m);
  rule.corner_m = {extent.xmin_m, extent.ymin_m, static_cast<double>(totals.min_m.z())};
  Cubes cubes = sample_cubes(pieces, extent, rule);
  std::unordered_map<std::uint64_t, std::uint64_t> columns;
  const auto column = [](std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32U) | (static_cast<std::uint64_t>(y) & 0xffffffffU);
  };
  for (std::uint32_t c = 0; c < cubes.size(); ++c) columns[column(cubes[c].key[0], cubes[c].key[1])] += cubes[c].count;
  std::array<std::uint64_t, kFew + 1> alone{};
  std::uint64_t all = 0;
  std::uint64_t over_others = 0;
  for (std::uint32_t c = 0; c < cubes.size(); ++c) {
    const Counted& cube = cubes[c];
    if (!cube.inner) continue;
    all += cube.count;
    if (cube.count > kFew) continue;
    const std::uint32_t around = count_around(cubes, cube.key, kFew);
    if (around > kFew) continue;
    alone[around] += cube.count;
    std::uint64_t beside = 0;
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t x = -1; x <= 1; ++x) {
        const auto found = columns.find(column(cube.key[0] + x, cube.key[1] + y));
        if (found != columns.end()) beside += found->second;
      }
    }
    over_others += beside >= kDense ? cube.count : 0U;
  }
  const std::uint64_t few = alone[1] + alone[2];
  if (few < kLeast || static_cast<double>(few) < kLeastShare * static_cast<double>(all) || 2 * over_others < few)
    return rule;
  // Poisson: of the points that are alone or with one other, those with one are as many times more as the mean.
  const double mean = static_cast<double>(alone[2]) / static_cast<double>(std::max<std::uint64_t>(1, alone[1]));
  rule.most = static_cast<std::uint32_t>(std::clamp(1.0 + mean + kSigmas * std::sqrt(mean), 2.0, kMost));
  return rule;
}

std::uint64_t flag_scattered(const OrientedPoints& points, const ScatterRule& rule, const BinLattice& lattice,
                             const BinWindow& counted, std::vector<std::uint8_t>& skip) {
  if (rule.most == 0) return 0;
  skip.resize(points.count, 0);
  const CubeGrid grid(rule);
  const auto cube_of = [&](std::size_t k, Cube& cube) {
    return grid.along(0, points.x[k], cube[0]) && grid.along(1, points.y[k], cube[1]) &&
           grid.along(2, points.z[k], cube[2]);
  };
  Cubes cubes;
  Cube cube{};
  for (std::size_t k = 0; k < points.count; ++k) {
    if (cube_of(k, cube)) ++cubes[cubes.number(cube)].count;
  }
  const BinLocator locator(lattice);
  std::uint64_t found = 0;
  for (std::size_t k = 0; k < points.count; ++k) {
    // Vertices of faces are no stray returns.
    if (skip[k] != 0 || !cube_of(k, cube) || count_at(cubes, cube) > rule.most) continue;
    if (count_around(cubes, cube, rule.most) > rule.most) continue;
    skip[k] = 1;
    int column = 0;
    int row = 0;
    if (!locator.locate(points.x[k], points.y[k], column, row)) continue;
    found += row >= counted.first_row && row < counted.last_row && column >= counted.first_column &&
                     column < counted.last_column
                 ? 1U
                 : 0U;
  }
  return found;
}

}  // namespace sparsha::pipeline
