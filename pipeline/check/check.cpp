// Both ways: every point (or a sample) to the bilinear surface, every measured node (or a sample) to its nearest point.
#include "pipeline/check/check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "pipeline/check/check_nearest.h"
#include "pipeline/check/check_statistics.h"
#include "pipeline/check/check_surface.h"
#include "pipeline/grid/fill_closing.h"

namespace sparsha::pipeline {
namespace {

constexpr int kBins = 64;
constexpr double kHistogramReach = 1.5;  // of the 99th percentile
constexpr std::size_t kPointsPerPiece = 1U << 14;
constexpr std::size_t kSamplesPerPiece = 512;
constexpr std::size_t kSecondMethodSamples = 2000;
constexpr int kSecondMethodRings = 24;  // points farther from the surface than this (spacings) are not judged twice

/// Points that count, relative to the lattice's origin, and a hash of each one's own bits.
struct Counted {
  std::vector<float> xyz;
  std::vector<std::uint64_t> key;
};

bool counts(const Projection& projection, std::size_t n) {
  if (projection.fate.empty()) return true;
  return projection.fate[n] == PointFate::used || projection.fate[n] == PointFate::outlier;
}

Counted counted_points(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                       ThreadPool& pool) {
  const std::size_t size = cloud.size();
  const std::size_t pieces = (size + kPointsPerPiece - 1) / kPointsPerPiece;
  std::vector<std::size_t> start(pieces + 1);
  pool.for_ranges(size, kPointsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t n = begin; n < end; ++n) count += counts(projection, n) ? 1 : 0;
    start[begin / kPointsPerPiece + 1] = count;
  });
  for (std::size_t k = 0; k < pieces; ++k) start[k + 1] += start[k];

  const Eigen::Matrix3d linear = scan_to_grid.topLeftCorner<3, 3>();
  const Eigen::Vector3d offset =
      linear * cloud.origin_m + scan_to_grid.topRightCorner<3, 1>() - projection.grid.lattice.origin_m;
  const float* source = cloud.xyz1();
  Counted result;
  result.xyz.resize(3 * start.back());
  result.key.resize(start.back());
  pool.for_ranges(size, kPointsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::size_t k = start[begin / kPointsPerPiece];
    for (std::size_t n = begin; n < end; ++n) {
      if (!counts(projection, n)) continue;
      const float* p = source + 4 * n;
      const Eigen::Vector3d q = linear * Eigen::Vector3d(p[0], p[1], p[2]) + offset;
      for (std::size_t axis = 0; axis < 3; ++axis)
        result.xyz[3 * k + axis] = static_cast<float>(q[static_cast<Eigen::Index>(axis)]);
      const std::uint64_t xy =
          std::bit_cast<std::uint32_t>(p[0]) | (std::uint64_t{std::bit_cast<std::uint32_t>(p[1])} << 32);
      result.key[k++] = hash_word(hash_word(xy) ^ std::bit_cast<std::uint32_t>(p[2]));
    }
  });
  return result;
}

/// Points in the order of the lattice's rows, so that neighbours in time are neighbours in memory.
void sort_by_place(std::vector<std::uint32_t>& sample, const std::vector<float>& xyz, const Lattice& lattice) {
  const double block = 8 * lattice.spacing_m;
  const auto key = [&](std::uint32_t n) {
    return std::pair{std::floor(xyz[3 * std::size_t{n} + 1] / block), xyz[3 * std::size_t{n}]};
  };
  std::vector<std::pair<std::pair<double, float>, std::uint32_t>> order;
  order.reserve(sample.size());
  for (const std::uint32_t n : sample) order.emplace_back(key(n), n);
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < sample.size(); ++k) sample[k] = order[k].second;
}

std::vector<float> distances_to_surface(const DepthGrid& grid, const std::vector<float>& xyz,
                                        const std::vector<std::uint32_t>& sample, CheckResult& result,
                                        ThreadPool& pool) {
  const SurfaceIndex surface(grid);
  std::vector<float> signed_m(sample.size());
  const std::size_t stride = std::max<std::size_t>(1, sample.size() / kSecondMethodSamples);
  const std::size_t pieces = (sample.size() + kSamplesPerPiece - 1) / kSamplesPerPiece;
  std::vector<std::uint64_t> judged(pieces);
  std::vector<double> worst(pieces);
  pool.for_ranges(sample.size(), kSamplesPerPiece, [&](std::size_t begin, std::size_t end) {
    SurfaceIndex::Scratch scratch;
    for (std::size_t k = begin; k < end; ++k) {
      const float* p = xyz.data() + 3 * std::size_t{sample[k]};
      const SurfaceDistance found = surface.distance(p[0], p[1], p[2], scratch);
      signed_m[k] = static_cast<float>(found.signed_m);
      if (k % stride != 0) continue;
      const SurfaceDistance second = surface.distance_by_walking(p[0], p[1], p[2], kSecondMethodRings);
      if (!std::isfinite(second.distance_m)) continue;
      ++judged[begin / kSamplesPerPiece];
      double& most = worst[begin / kSamplesPerPiece];
      most = std::max(most, std::abs(second.distance_m - found.distance_m));
    }
  });
  for (std::size_t k = 0; k < pieces; ++k) {
    result.second_method_samples += judged[k];
    result.second_method_max_difference_m = std::max(result.second_method_max_difference_m, worst[k]);
  }
  return signed_m;
}

/// Mean distance of the sampled points that lie nearest to each node.
std::vector<float> error_map(const Lattice& lattice, const std::vector<float>& xyz,
                             const std::vector<std::uint32_t>& sample, const std::vector<float>& signed_m) {
  std::vector<float> error(lattice.count(), kUnknownHeight);
  std::vector<std::uint32_t> hits(lattice.count());
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const double i = std::round(xyz[3 * std::size_t{sample[k]}] / lattice.spacing_m);
    const double j = std::round(xyz[3 * std::size_t{sample[k]} + 1] / lattice.spacing_m);
    if (!(i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny)) continue;
    const std::size_t n = lattice.index(static_cast<int>(i), static_cast<int>(j));
    const float distance = std::abs(signed_m[k]);
    ++hits[n];
    error[n] = hits[n] == 1 ? distance : error[n] + (distance - error[n]) / static_cast<float>(hits[n]);
  }
  return error;
}

}  // namespace

CheckResult cross_check(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                        const std::optional<FillConfig>& fill, const CheckConfig& config, ThreadPool& pool,
                        Progress& progress) {
  const DepthGrid& grid = projection.grid;
  const Lattice& lattice = grid.lattice;
  const auto wanted = static_cast<std::uint64_t>(std::max<std::int64_t>(0, config.samples));
  CheckResult result;
  result.tolerance_m = std::max(lattice.spacing_m, 3 * projection.noise_m);

  const Counted points = counted_points(cloud, scan_to_grid, projection, pool);
  progress.at(0.1);
  std::vector<std::uint32_t> sample = choose_sample(points.key, wanted);
  sort_by_place(sample, points.xyz, lattice);
  std::vector<float> distances = distances_to_surface(grid, points.xyz, sample, result, pool);
  // A grid without a single cell has no surface to be distant from.
  if (!distances.empty() && std::isinf(distances.front()))
    distances.clear();
  else
    result.node_error_m = error_map(lattice, points.xyz, sample, distances);
  if (result.node_error_m.empty()) result.node_error_m.assign(lattice.count(), kUnknownHeight);
  result.cloud_to_surface = statistics_of(distances, points.key.size());
  result.histogram_bin_m = kHistogramReach * result.cloud_to_surface.p99_m / kBins;
  result.cloud_histogram = histogram_of(distances, result.histogram_bin_m, kBins);
  progress.at(0.5);

  std::vector<std::uint32_t> measured;
  for (std::size_t n = 0; n < lattice.count(); ++n)
    if (grid.state[n] == NodeState::measured) measured.push_back(static_cast<std::uint32_t>(n));
  std::vector<std::uint64_t> keys(measured.size());
  for (std::size_t k = 0; k < measured.size(); ++k) keys[k] = hash_word(measured[k]);
  std::vector<std::uint32_t> nodes = choose_sample(keys, wanted);
  for (std::uint32_t& k : nodes) k = measured[k];
  distances = nearest_point_distances(grid, nodes, points.xyz, projection.point_spacing_m, pool);
  if (points.key.empty()) distances.clear();
  result.surface_to_cloud = statistics_of(distances, measured.size());
  result.surface_histogram_bin_m = kHistogramReach * result.surface_to_cloud.p99_m / kBins;
  result.surface_histogram = histogram_of(distances, result.surface_histogram_bin_m, kBins);
  progress.at(0.9);

  const std::size_t inside = outline_nodes(grid, fill ? fill->max_gap_m : 0.0, pool).count();
  if (inside > 0 && !distances.empty()) {
    const auto near =
        std::count_if(distances.begin(), distances.end(), [&](float d) { return std::abs(d) <= result.tolerance_m; });
    const double share = static_cast<double>(near) / static_cast<double>(distances.size());
    result.completeness = share * static_cast<double>(measured.size()) / static_cast<double>(inside);
  } else if (inside > 0) {
    result.completeness = 0.0;
  }
  progress.at(1.0);
  return result;
}

}  // namespace sparsha::pipeline
