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
constexpr std::size_t kSamplesPerPiece = 512;
constexpr std::size_t kSecondMethodSamples = 2000;
constexpr int kSecondMethodRings = 24;  // points farther from the surface than this (spacings) are not judged twice

bool counts(const Projection& projection, std::size_t n) {
  if (projection.fate.empty()) return true;
  return projection.fate[n] == PointFate::used || projection.fate[n] == PointFate::outlier;
}

BandedPoints counted_points(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                            ThreadPool& pool) {
  const Eigen::Matrix3d linear = scan_to_grid.topLeftCorner<3, 3>();
  const Eigen::Vector3d offset =
      linear * cloud.origin_m + scan_to_grid.topRightCorner<3, 1>() - projection.grid.lattice.origin_m;
  const float* source = cloud.xyz1();
  const auto write = [&](std::size_t begin, std::size_t end, float* xyz) {
    const float* const start = xyz;
    for (std::size_t n = begin; n < end; ++n) {
      if (!counts(projection, n)) continue;
      const double x = source[4 * n], y = source[4 * n + 1], z = source[4 * n + 2];
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        *xyz++ = static_cast<float>(linear(axis, 0) * x + linear(axis, 1) * y + linear(axis, 2) * z + offset[axis]);
    }
    return static_cast<std::size_t>(xyz - start) / 3;
  };
  return {projection.grid.lattice, cloud.size(), write, pool};
}

/// A sample of the points, chosen by their own bits, in an order that walks the lattice.
std::vector<std::uint32_t> sample_points(const BandedPoints& points, std::uint64_t wanted, const Lattice& lattice) {
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
  std::vector<std::uint32_t> sample = choose_sample(points.size(), wanted, [&](std::size_t n) {
    const float* p = points.point(n);
    return hash_word(hash_word(bits(p[0]) | bits(p[1]) << 32) ^ bits(p[2]));
  });
  const auto per_block = static_cast<float>(1 / (8 * lattice.spacing_m));
  std::vector<Keyed> order;
  order.reserve(sample.size());
  for (const std::uint32_t n : sample) {
    const float* p = points.point(n);
    const auto row = static_cast<std::uint64_t>(std::clamp(p[1] * per_block, 0.0F, 1e9F));
    // Non-negative floats sort like their bits.
    order.push_back({row << 32 | bits(std::max(p[0], 0.0F)), n});
  }
  std::sort(order.begin(), order.end(), [&](const Keyed& a, const Keyed& b) {
    if (a.key != b.key) return a.key < b.key;
    return std::lexicographical_compare(points.point(a.item), points.point(a.item) + 3, points.point(b.item),
                                        points.point(b.item) + 3);
  });
  for (std::size_t k = 0; k < sample.size(); ++k) sample[k] = order[k].item;
  return sample;
}

std::vector<float> distances_to_surface(const DepthGrid& grid, const BandedPoints& points,
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
      const float* p = points.point(sample[k]);
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
std::vector<float> error_map(const Lattice& lattice, const BandedPoints& points,
                             const std::vector<std::uint32_t>& sample, const std::vector<float>& signed_m) {
  std::vector<float> error(lattice.count(), kUnknownHeight);
  std::vector<std::uint32_t> hits(lattice.count());
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const double i = std::round(points.point(sample[k])[0] / lattice.spacing_m);
    const double j = std::round(points.point(sample[k])[1] / lattice.spacing_m);
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

  const BandedPoints points = counted_points(cloud, scan_to_grid, projection, pool);
  progress.at(0.1);
  const std::vector<std::uint32_t> sample = sample_points(points, wanted, lattice);
  std::vector<float> distances = distances_to_surface(grid, points, sample, result, pool);
  // A grid without a single cell has no surface to be distant from.
  if (!distances.empty() && std::isinf(distances.front()))
    distances.clear();
  else
    result.node_error_m = error_map(lattice, points, sample, distances);
  if (result.node_error_m.empty()) result.node_error_m.assign(lattice.count(), kUnknownHeight);
  result.cloud_to_surface = statistics_of(distances, points.size());
  result.histogram_bin_m = kHistogramReach * result.cloud_to_surface.p99_m / kBins;
  result.cloud_histogram = histogram_of(distances, result.histogram_bin_m, kBins);
  progress.at(0.5);

  std::vector<std::uint32_t> measured;
  for (std::size_t n = 0; n < lattice.count(); ++n)
    if (grid.state[n] == NodeState::measured) measured.push_back(static_cast<std::uint32_t>(n));
  std::vector<std::uint32_t> nodes =
      choose_sample(measured.size(), wanted, [&](std::size_t k) { return hash_word(measured[k]); });
  for (std::uint32_t& k : nodes) k = measured[k];
  distances = nearest_point_distances(grid, nodes, points, projection.point_spacing_m, pool);
  if (points.size() == 0) distances.clear();
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
