// Bilateral-filtered heights (Tomasi & Manduchi 1998), aware of unknown nodes and a pure function of a node's
// neighbourhood.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "base/numbers/hash.h"
#include "pipeline/images/images.h"
#include "pipeline/layers/bilateral_kernel.h"
#include "pipeline/layers/layers.h"

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 3.0;           // sigmas of space; the ring beyond holds 1.1 % of the Gaussian
constexpr double kSigmasPerBlock = 4.0;  // nodes of sigma for each node of a block's side
constexpr int kLeastRows = 128;          // of a piece; it looks at `reach` rows more
constexpr int kLeastColumns = 512;       // of a piece, so that what two rows add up stays in the first cache
constexpr float kFarBelow_m = -1e9F;     // in place of an unknown height: weighs 2^-100

/// Which of the `stride` x `stride` nodes of a block stands for all of them: any one, the same every time, and mirrored
/// with the block, so that a plane stays a plane. A regular choice would mistake texture of its own period for form.
std::array<int, 2> representative(int block_x, int block_y, int stride) {
  const bool mirrored = block_y < 0 || (block_y == 0 && block_x < 0);
  if (mirrored) {
    const auto [x, y] = representative(-block_x, -block_y, stride);
    return {-x, -y};
  }
  const std::uint64_t bits =
      hash_word((static_cast<std::uint64_t>(block_x + (1 << 20)) << 32) + static_cast<std::uint64_t>(block_y));
  const auto pick = [&](int shift) {
    return static_cast<int>((bits >> shift) % static_cast<std::uint64_t>(stride)) - (stride - 1) / 2;
  };
  return {block_x * stride + pick(11), block_y * stride + pick(37)};
}

/// A node (dx, dy) beside the centre, of which 2^-space is the Gaussian weight; dy > 0, or dy = 0 and dx > 0: the
/// weight of a pair is the same from both of its nodes.
struct Tap {
  int dx, dy;
  float space;
};

/// Half of the nodes within `reach` (in spacings), by rows. Where the Gaussian is so wide that it averages hundreds of
/// nodes anyway, one node stands for each block of up to a quarter sigma.
std::vector<Tap> make_taps(double sigma, double reach) {
  std::vector<Tap> taps;
  const int block = std::max(1, static_cast<int>(sigma / kSigmasPerBlock));
  const int radius = static_cast<int>(reach) / block + 1;
  for (int by = 0; by <= radius; ++by)
    for (int bx = -radius; bx <= radius; ++bx) {
      if (by == 0 && bx <= 0) continue;
      auto [dx, dy] = representative(bx, by, block);
      if (dy < 0 || (dy == 0 && dx < 0)) dx = -dx, dy = -dy;
      const double squared = static_cast<double>(dx) * dx + static_cast<double>(dy) * dy;
      if (squared > reach * reach) continue;
      taps.push_back({dx, dy, static_cast<float>(squared / (2 * sigma * sigma) * std::numbers::log2e)});
    }
  std::stable_sort(taps.begin(), taps.end(), [](const Tap& a, const Tap& b) { return a.dy < b.dy; });
  return taps;
}

/// Some rows of floats, each in the place of the one that lies as many rows below.
class Rows {
 public:
  Rows(int rows, int columns) : rows_(rows), columns_(static_cast<std::size_t>(columns)) {
    values_.resize(static_cast<std::size_t>(rows) * columns_);
  }
  [[nodiscard]] float* at(int row) { return values_.data() + static_cast<std::size_t>(row % rows_) * columns_; }
  void fill(int row, float value) { std::fill_n(at(row), columns_, value); }

 private:
  int rows_;
  std::size_t columns_;
  std::vector<float> values_;
};

/// Columns and rows [first, last).
struct Range {
  int first, last;
};

/// The filter of a piece of the lattice. Each pair of nodes is looked at once, for both of them. What a node adds up
/// has one order, by the places of its neighbours, whatever the pieces are.
class PairFilter {
 public:
  PairFilter(const scene::DepthGrid& grid, const std::vector<Tap>& taps, int reach, float range, Range columns)
      : grid_(grid),
        taps_(taps),
        reach_(reach),
        range_(range),
        columns_(columns),
        seen_{std::max(0, columns.first - reach), std::min(grid.lattice.nx, columns.last + reach)},
        heights_(std::min(reach + 1, grid.lattice.ny), seen_.last - seen_.first),
        weights_(std::min(reach + 1, grid.lattice.ny), seen_.last - seen_.first),
        sums_(std::min(reach + 1, grid.lattice.ny), seen_.last - seen_.first),
        beside_(2, seen_.last - seen_.first) {}

  void run(Range rows, float* envelope_m) {
    int loaded = std::max(0, rows.first - reach_);
    for (int row = loaded; row < rows.last; ++row) {
      for (; loaded < std::min(grid_.lattice.ny, row + reach_ + 1); ++loaded) load(loaded);
      add_pairs_of(row, rows.first);
      if (row >= rows.first) write(row, envelope_m);
    }
  }

 private:
  void load(int row) {
    const float* from = grid_.height_m.data() + grid_.lattice.index(seen_.first, row);
    std::transform(from, from + (seen_.last - seen_.first), heights_.at(row),
                   [](float z) { return std::isnan(z) ? kFarBelow_m : z; });
    weights_.fill(row, 1.0F);
    sums_.fill(row, 0.0F);
  }

  /// Pairs of a node in `row` and one beside or above it, from row `first_wanted` on.
  void add_pairs_of(int row, int first_wanted) {
    bool above = false;
    beside_.fill(0, 0.0F);
    beside_.fill(1, 0.0F);
    for (const Tap& tap : taps_) {
      const int other = row + tap.dy;
      if (other >= grid_.lattice.ny) break;
      if (other < first_wanted) continue;
      if (tap.dy > 0 && !std::exchange(above, true)) add_beside(row);
      const int first = std::max({seen_.first, seen_.first - tap.dx, columns_.first - std::max(0, tap.dx)});
      const int last = std::min({seen_.last, seen_.last - tap.dx, columns_.last - std::min(0, tap.dx)});
      if (first >= last) continue;
      const int a = first - seen_.first, b = a + tap.dx;
      float* const weights = tap.dy > 0 ? weights_.at(other) : beside_.at(0);
      float* const sums = tap.dy > 0 ? sums_.at(other) : beside_.at(1);
      pairs_(heights_.at(row) + a, heights_.at(other) + b, static_cast<std::size_t>(last - first), range_, tap.space,
             weights_.at(row) + a, sums_.at(row) + a, weights + b, sums + b);
    }
    if (!above) add_beside(row);
  }

  /// What nodes got of those to their left, which the kernel may not add where it adds those to their right.
  void add_beside(int row) {
    const auto add = [this](const float* from, float* to) {
      std::transform(from, from + (seen_.last - seen_.first), to, to, std::plus<float>());
    };
    add(beside_.at(0), weights_.at(row));
    add(beside_.at(1), sums_.at(row));
  }

  void write(int row, float* envelope_m) {
    const std::size_t first = grid_.lattice.index(columns_.first, row);
    const int offset = columns_.first - seen_.first;
    const float* const weights = weights_.at(row) + offset;
    const float* const sums = sums_.at(row) + offset;
    for (std::size_t i = 0; i < static_cast<std::size_t>(columns_.last - columns_.first); ++i)
      envelope_m[first + i] = grid_.height_m[first + i] + sums[i] / weights[i];
  }

  const scene::DepthGrid& grid_;
  const std::vector<Tap>& taps_;
  int reach_;
  float range_;
  Range columns_, seen_;
  kernel::BilateralPairs pairs_ = kernel::bilateral_pairs();
  Rows heights_, weights_, sums_;
  Rows beside_;  // weights and sums that a row's nodes give those to their right
};

std::vector<float> direct(const scene::DepthGrid& grid, double sigma_space, double sigma_range_m, ThreadPool& pool) {
  const double reach = kReach * sigma_space;
  const std::vector<Tap> taps = make_taps(sigma_space, reach);
  const auto range = static_cast<float>(std::numbers::log2e / (2 * sigma_range_m * sigma_range_m));
  const int nodes = static_cast<int>(reach);
  const scene::Lattice& lattice = grid.lattice;
  const int rows = std::max(kLeastRows, 2 * nodes), columns = std::max(kLeastColumns, 4 * nodes);
  const int across = (lattice.nx + columns - 1) / columns, along = (lattice.ny + rows - 1) / rows;
  std::vector<float> envelope(lattice.count());
  pool.for_ranges(static_cast<std::size_t>(across) * static_cast<std::size_t>(along), 1,
                  [&](std::size_t begin, std::size_t end) {
                    for (int piece = static_cast<int>(begin); piece < static_cast<int>(end); ++piece) {
                      const int left = piece % across * columns, bottom = piece / across * rows;
                      PairFilter filter(grid, taps, nodes, range, {left, std::min(lattice.nx, left + columns)});
                      filter.run({bottom, std::min(lattice.ny, bottom + rows)}, envelope.data());
                    }
                  });
  return envelope;
}

/// OpenCV's filter. Its range table spans the image, and it knows no NaN: unknown nodes take a height so far below that
/// they weigh nothing.
std::vector<float> opencv(const scene::DepthGrid& grid, double sigma_space, double sigma_range_m) {
  float low = std::numeric_limits<float>::infinity();
  for (const float z : grid.height_m)
    if (z < low) low = z;
  std::vector<float> envelope(grid.lattice.count(), scene::kUnknownHeight);
  if (!std::isfinite(low)) return envelope;
  const auto beyond = static_cast<float>(low - 20 * sigma_range_m);
  Image source{grid.lattice.ny, grid.lattice.nx, grid.height_m};
  for (float& z : source.values)
    if (std::isnan(z)) z = beyond;
  const int diameter = 2 * static_cast<int>(kReach * sigma_space) + 1;
  const Image filtered = images().bilateral(std::move(source), diameter, sigma_range_m, sigma_space);
  for (std::size_t n = 0; n < envelope.size(); ++n)
    if (!std::isnan(grid.height_m[n])) envelope[n] = filtered.values[n];
  return envelope;
}

}  // namespace

std::vector<float> bilateral_envelope(const scene::DepthGrid& grid, const scene::TextureConfig& config,
                                      ThreadPool& pool) {
  // Beyond the lattice's own size a wider Gaussian changes nothing that could be seen.
  const double sigma_space =
      std::min(config.sigma_space_m / grid.lattice.spacing_m, static_cast<double>(grid.lattice.nx + grid.lattice.ny));
  if (kReach * sigma_space < 1) return grid.height_m;
  if (config.method == scene::TextureConfig::Method::opencv) return opencv(grid, sigma_space, config.sigma_range_m);
  return direct(grid, sigma_space, config.sigma_range_m, pool);
}

}  // namespace sparsha::pipeline
