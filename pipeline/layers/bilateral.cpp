// Bilateral-filtered heights (Tomasi & Manduchi 1998), aware of unknown nodes and a pure function of a node's
// neighbourhood.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/hash.h"
#include "pipeline/images/images.h"
#include "pipeline/layers/bilateral_kernel.h"
#include "pipeline/layers/layers.h"

namespace sparsha::pipeline {
namespace {

constexpr double kReach = 3.0;           // sigmas of space; the ring beyond holds 1.1 % of the Gaussian
constexpr double kSigmasPerBlock = 4.0;  // nodes of sigma for each node of a block's side
constexpr std::size_t kRowsPerPiece = 16;

/// Heights with a border of NaN, so that the kernel never asks where the lattice ends.
struct Padded {
  std::vector<float> values;
  std::size_t stride = 0;
  int margin = 0;

  Padded(const scene::DepthGrid& grid, int border)
      : stride(static_cast<std::size_t>(grid.lattice.nx + 2 * border)), margin(border) {
    values.assign(stride * static_cast<std::size_t>(grid.lattice.ny + 2 * border), scene::kUnknownHeight);
    for (int j = 0; j < grid.lattice.ny; ++j) {
      const auto row = grid.height_m.begin() + static_cast<std::ptrdiff_t>(grid.lattice.index(0, j));
      std::copy_n(row, grid.lattice.nx, values.begin() + (at(0, j) - values.data()));
    }
  }
  [[nodiscard]] const float* at(int i, int j) const {
    return values.data() + static_cast<std::size_t>(j + margin) * stride + static_cast<std::size_t>(i + margin);
  }
};

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

/// All nodes within `reach` (in spacings) but the centre, with their Gaussian weights. Where the Gaussian is so wide
/// that it averages hundreds of nodes anyway, one node stands for each block of up to a quarter sigma.
std::vector<kernel::BilateralTap> make_taps(double sigma, double reach, std::size_t stride) {
  std::vector<kernel::BilateralTap> taps;
  const int block = std::max(1, static_cast<int>(sigma / kSigmasPerBlock));
  const int radius = static_cast<int>(reach) / block + 1;
  for (int by = -radius; by <= radius; ++by)
    for (int bx = -radius; bx <= radius; ++bx) {
      if (bx == 0 && by == 0) continue;
      const auto [dx, dy] = representative(bx, by, block);
      const double squared = static_cast<double>(dx) * dx + static_cast<double>(dy) * dy;
      if (squared > reach * reach) continue;
      taps.push_back({static_cast<std::ptrdiff_t>(dy) * static_cast<std::ptrdiff_t>(stride) + dx,
                      static_cast<float>(std::exp(-squared / (2 * sigma * sigma)))});
    }
  return taps;
}

std::vector<float> direct(const scene::DepthGrid& grid, double sigma_space, double sigma_range_m, ThreadPool& pool) {
  const double reach = kReach * sigma_space;
  const Padded padded(grid, static_cast<int>(reach));
  const std::vector<kernel::BilateralTap> taps = make_taps(sigma_space, reach, padded.stride);
  const auto range = static_cast<float>(1.0 / (2 * sigma_range_m * sigma_range_m));
  const kernel::BilateralRow row = kernel::bilateral_row();
  const auto nx = static_cast<std::size_t>(grid.lattice.nx);
  std::vector<float> envelope(grid.lattice.count());
  pool.for_ranges(static_cast<std::size_t>(grid.lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<float> sums(2 * nx);
    for (std::size_t j = begin; j < end; ++j)
      row(padded.at(0, static_cast<int>(j)), nx, taps.data(), taps.size(), range, sums.data(),
          envelope.data() + j * nx);
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
