// Samples by picture and not by area: a wall that the view sees edge-on is no part of what it can show.
#include "pipeline/check/seen_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/numbers/hash.h"
#include "pipeline/check/points.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kNodesPerPiece = 1U << 14U;
constexpr std::size_t kPointsPerPiece = 1U << 16U;
constexpr std::uint64_t kSeed = 0x6d657368;  // so that nodes and places are not sampled alike

std::vector<std::uint8_t> flag_corners(const Cloud& cloud) {
  std::vector<std::uint8_t> flags(cloud.size(), 0);
  for (const std::array<std::uint32_t, 3>& face : cloud.faces) {
    for (const std::uint32_t v : face) {
      if (v >= flags.size()) {
        throw input_error({}, "a face names point " + std::to_string(v), "faces index existing points");
      }
      flags[v] = 1;
    }
  }
  return flags;
}

std::vector<float> in_lattice(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Lattice& lattice,
                              ThreadPool& pool) {
  const ToLattice to_lattice(scan_to_grid, cloud.origin_m, lattice);
  std::vector<float> xyz(3 * cloud.size());
  const float* const source = cloud.xyz1();
  pool.for_ranges(cloud.size(), kPointsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) to_lattice(source + 4 * n, xyz.data() + 3 * n);
  });
  return xyz;
}

/// 0 to 1, from the bits of a hash.
double fraction(std::uint64_t hash) { return static_cast<double>(hash >> 11U) * 0x1p-53; }

}  // namespace

SeenMesh::SeenMesh(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                   ThreadPool& pool)
    : grid_(projection.grid),
      gap_m_(projection.gap_m),
      corners_(flag_corners(cloud)),
      only_mesh_(std::find(corners_.begin(), corners_.end(), std::uint8_t{0}) == corners_.end()),
      triangles_(in_lattice(cloud, scan_to_grid, projection.grid.lattice, pool), cloud.faces, pool) {}

bool SeenMesh::is_behind_points(double column, double row, double z_m) const {
  const int i0 = static_cast<int>(column);
  const int j0 = static_cast<int>(row);
  bool known = false;
  for (int j = j0; j <= std::min(j0 + 1, grid_.lattice.ny - 1); ++j)
    for (int i = i0; i <= std::min(i0 + 1, grid_.lattice.nx - 1); ++i) {
      const auto height_m = static_cast<double>(grid_.height_m[grid_.lattice.index(i, j)]);
      if (std::isnan(height_m)) continue;
      known = true;
      if (!(height_m - gap_m_ > z_m)) return false;
    }
  return known;
}

std::vector<SampledPlace> SeenMesh::places(std::uint64_t threshold, const Context& context) const {
  const scene::Lattice& lattice = grid_.lattice;
  std::vector<std::vector<SampledPlace>> parts((lattice.count() + kNodesPerPiece - 1) / kNodesPerPiece);
  context.pool.for_ranges(lattice.count(), kNodesPerPiece, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t n = begin; n < end; ++n) {
      const std::uint64_t key = hash_word(n ^ kSeed << 32U);
      if (key > threshold) continue;
      const auto nx = static_cast<std::size_t>(lattice.nx);
      const double across = fraction(hash_word(key));
      const double up = fraction(hash_word(hash_word(key)));
      // Beyond the outermost nodes the grid says nothing.
      const double column = std::clamp(static_cast<double>(n % nx) + across - 0.5, 0.0, lattice.nx - 1.0);
      const double row = std::clamp(static_cast<double>(n / nx) + up - 0.5, 0.0, lattice.ny - 1.0);
      const double x = column * lattice.spacing_m;
      const double y = row * lattice.spacing_m;
      const std::optional<double> z = triangles_.highest(x, y);
      if (!z || (!only_mesh_ && is_behind_points(column, row, *z))) continue;
      parts[begin / kNodesPerPiece].push_back(
          {key, {static_cast<float>(x), static_cast<float>(y), static_cast<float>(*z)}});
    }
  });
  std::vector<SampledPlace> all;
  for (const std::vector<SampledPlace>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace sparsha::pipeline
