// Both ways: every point (or a sample) to the bilinear surface, every measured node (or a sample) to its nearest point.
#include "pipeline/check/check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "base/hash.h"
#include "pipeline/check/nearest.h"
#include "pipeline/check/points.h"
#include "pipeline/check/statistics.h"
#include "pipeline/check/surface.h"
#include "pipeline/layers/closing.h"

namespace sparsha::pipeline {
namespace {

constexpr int kBins = 64;
constexpr double kHistogramReach = 1.5;  // of the 99th percentile
constexpr std::size_t kSamplesPerPiece = 512;
constexpr std::size_t kSecondMethodSamples = 2000;
constexpr int kSecondMethodRings = 24;  // points farther from the surface than this (spacings) are not judged twice

bool counts(const Projection& projection, std::size_t n) {
  if (projection.point_class.empty()) return true;
  return projection.point_class[n] == PointClass::used || projection.point_class[n] == PointClass::outlier;
}

BandedPoints counted_points(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                            ThreadPool& pool) {
  const ToLattice to_lattice(scan_to_grid, cloud.origin_m, projection.grid.lattice);
  const float* source = cloud.xyz1();
  const auto write = [&](std::size_t begin, std::size_t end, float* xyz) {
    const float* const start = xyz;
    for (std::size_t n = begin; n < end; ++n) {
      if (!counts(projection, n)) continue;
      to_lattice(source + 4 * n, xyz);
      xyz += 3;
    }
    return static_cast<std::size_t>(xyz - start) / 3;
  };
  return {projection.grid.lattice, cloud.size(), write, pool};
}

using Place = std::array<float, 3>;

/// A sample of the points (0 = all), chosen by their own bits, in an order that walks the lattice.
std::vector<Place> sample_points(const CountedPoints& points, std::uint64_t wanted, const Lattice& lattice) {
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
  struct Candidate {
    std::uint64_t key;
    Place place;
  };
  std::vector<Candidate> sample;
  if (wanted == 0 || wanted > points.size) wanted = points.size;
  sample.reserve(sample_room(points.size, wanted));
  for (std::uint64_t threshold = sample_threshold(points.size, wanted);; threshold = ~std::uint64_t{0}) {
    sample.clear();
    points.each([&](std::span<const float> xyz) {
      for (std::size_t n = 0; n < xyz.size(); n += 3) {
        const float* p = xyz.data() + n;
        const std::uint64_t key = hash_word(hash_word(bits(p[0]) | bits(p[1]) << 32) ^ bits(p[2]));
        if (key <= threshold) sample.push_back({key, {p[0], p[1], p[2]}});
      }
    });
    if (sample.size() >= wanted) break;
  }
  const auto before = [](const Candidate& a, const Candidate& b) {
    return a.key != b.key ? a.key < b.key : a.place < b.place;
  };
  if (wanted < sample.size()) {
    std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(wanted), sample.end(), before);
    sample.resize(static_cast<std::size_t>(wanted));
  }
  const auto per_block = static_cast<float>(1 / (8 * lattice.spacing_m));
  for (Candidate& c : sample) {
    const auto row = static_cast<std::uint64_t>(std::clamp(c.place[1] * per_block, 0.0F, 1e9F));
    // Non-negative floats sort like their bits.
    c.key = row << 32 | bits(std::max(c.place[0], 0.0F));
  }
  std::sort(sample.begin(), sample.end(), before);
  std::vector<Place> places;
  places.reserve(sample.size());
  for (const Candidate& c : sample) places.push_back(c.place);
  return places;
}

std::vector<float> distances_to_surface(const DepthGrid& grid, const std::vector<Place>& sample, CheckResult& result,
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
      const Place& p = sample[k];
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
std::vector<float> error_map(const Lattice& lattice, const std::vector<Place>& sample,
                             const std::vector<float>& signed_m) {
  std::vector<std::pair<std::size_t, std::size_t>> hits;  // node and place in the sample
  hits.reserve(sample.size());
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const double i = std::round(sample[k][0] / lattice.spacing_m);
    const double j = std::round(sample[k][1] / lattice.spacing_m);
    if (!(i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny)) continue;
    hits.emplace_back(lattice.index(static_cast<int>(i), static_cast<int>(j)), k);
  }
  std::sort(hits.begin(), hits.end());
  std::vector<float> error(lattice.count(), kUnknownHeight);
  std::size_t here = 0;
  for (std::size_t h = 0; h < hits.size(); ++h) {
    const auto [n, k] = hits[h];
    here = h > 0 && hits[h - 1].first == n ? here + 1 : 1;
    const float distance = std::abs(signed_m[k]);
    error[n] = here == 1 ? distance : error[n] + (distance - error[n]) / static_cast<float>(here);
  }
  return error;
}

/// A sample of the measured nodes (0 = all), ascending, and how many there are.
std::vector<std::uint32_t> sample_nodes(const DepthGrid& grid, std::uint64_t wanted, std::uint64_t& measured) {
  measured = static_cast<std::uint64_t>(std::count(grid.state.begin(), grid.state.end(), NodeState::measured));
  return choose_sample(measured, wanted, [&](const auto& offer) {
    for (std::size_t n = 0; n < grid.state.size(); ++n)
      if (grid.state[n] == NodeState::measured) offer(hash_word(n), n);
  });
}

}  // namespace

CheckResult cross_check(const CountedPoints& points, const DepthGrid& grid, double noise_m, double point_spacing_m,
                        const std::optional<FillConfig>& fill, const CheckConfig& config, const Context& context) {
  const Lattice& lattice = grid.lattice;
  const auto wanted = static_cast<std::uint64_t>(std::max<std::int64_t>(0, config.samples));
  CheckResult result;
  // A noise of more than half the distance between points cannot be right, and must not excuse the surface.
  result.tolerance_m = std::max(lattice.spacing_m, 3 * std::min(noise_m, 0.5 * point_spacing_m));

  context.progress.at(0.1);
  const std::vector<Place> sample = sample_points(points, wanted, lattice);
  context.progress.at(0.3);
  std::vector<float> distances = distances_to_surface(grid, sample, result, context.pool);
  // A grid without a single cell has no surface to be distant from.
  if (!distances.empty() && std::isinf(distances.front()))
    distances.clear();
  else
    result.node_error_m = error_map(lattice, sample, distances);
  if (result.node_error_m.empty()) result.node_error_m.assign(lattice.count(), kUnknownHeight);
  result.cloud_to_surface = statistics_of(distances, points.size);
  result.histogram_bin_m = kHistogramReach * result.cloud_to_surface.p99_m / kBins;
  result.cloud_histogram = histogram_of(distances, result.histogram_bin_m, kBins);
  context.progress.at(0.5);

  std::uint64_t measured = 0;
  const std::vector<std::uint32_t> nodes = sample_nodes(grid, wanted, measured);
  distances = nearest_point_distances(grid, nodes, points, point_spacing_m, context.pool);
  if (points.size == 0) distances.clear();
  result.surface_to_cloud = statistics_of(distances, measured);
  result.surface_histogram_bin_m = kHistogramReach * result.surface_to_cloud.p99_m / kBins;
  result.surface_histogram = histogram_of(distances, result.surface_histogram_bin_m, kBins);
  context.progress.at(0.9);

  const std::size_t inside = outline_nodes(grid, fill ? fill->max_gap_m : 0.0, context.pool).count();
  if (inside > 0 && !distances.empty()) {
    const auto near =
        std::count_if(distances.begin(), distances.end(), [&](float d) { return std::abs(d) <= result.tolerance_m; });
    const double share = static_cast<double>(near) / static_cast<double>(distances.size());
    result.completeness = share * static_cast<double>(measured) / static_cast<double>(inside);
  } else if (inside > 0) {
    result.completeness = 0.0;
  }
  context.progress.at(1.0);
  return result;
}

CheckResult cross_check(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                        const std::optional<FillConfig>& fill, const CheckConfig& config, const Context& context) {
  const BandedPoints points = counted_points(cloud, scan_to_grid, projection, context.pool);
  return cross_check(points.counted(), projection.grid, projection.noise_m, projection.point_spacing_m, fill, config,
                     context);
}

}  // namespace sparsha::pipeline
