// Both ways: every point (or a sample) to the bilinear surface, every measured node (or a sample) to its nearest point.
#include "pipeline/check/check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "base/numbers/hash.h"
#include "pipeline/check/nearest.h"
#include "pipeline/check/points.h"
#include "pipeline/check/seen_mesh.h"
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

/// Without those that `left_out` flags, which may be empty.
BandedPoints counted_points(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                            const std::vector<std::uint8_t>& left_out, ThreadPool& pool) {
  const ToLattice to_lattice(scan_to_grid, cloud.origin_m, projection.grid.lattice);
  const float* source = cloud.xyz1();
  const auto write = [&](std::size_t begin, std::size_t end, float* xyz) {
    const float* const start = xyz;
    for (std::size_t n = begin; n < end; ++n) {
      if (!counts(projection, n) || (!left_out.empty() && left_out[n] != 0)) continue;
      to_lattice(source + 4 * n, xyz);
      xyz += 3;
    }
    return static_cast<std::size_t>(xyz - start) / 3;
  };
  return {projection.grid.lattice, cloud.size(), write, pool};
}

using Place = std::array<float, 3>;

/// The points whose keys are at most `threshold`.
void draw_points(const CountedPoints& points, std::uint64_t threshold, std::vector<SampledPlace>& sample) {
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
  points.each([&](std::span<const float> xyz) {
    for (std::size_t n = 0; n < xyz.size(); n += 3) {
      const float* p = xyz.data() + n;
      const std::uint64_t key = hash_word(hash_word(bits(p[0]) | bits(p[1]) << 32) ^ bits(p[2]));
      if (key <= threshold) sample.push_back({key, {p[0], p[1], p[2]}});
    }
  });
}

/// A sample of the points and of the mesh (0 = all), chosen by the points' own bits, in an order that walks the
/// lattice.
std::vector<Place> sample_places(const CountedPoints& points, const SeenMesh* mesh, const scene::DepthGrid& grid,
                                 std::uint64_t wanted, const Context& context) {
  const scene::Lattice& lattice = grid.lattice;
  std::uint64_t population = points.size;
  std::uint64_t expected = population;  // of the mesh, as many places as there are measured nodes
  if (mesh != nullptr) {
    population += lattice.count();
    expected +=
        static_cast<std::uint64_t>(std::count(grid.state.begin(), grid.state.end(), scene::NodeState::measured));
  }
  if (wanted == 0 || wanted > population) wanted = population;
  std::vector<SampledPlace> sample;
  sample.reserve(sample_room(expected, std::min(expected, wanted)));
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  constexpr std::uint64_t kWider = 8;
  for (std::uint64_t threshold = sample_threshold(expected, std::min(expected, wanted));;) {
    sample.clear();
    draw_points(points, threshold, sample);
    if (mesh != nullptr) {
      const std::vector<SampledPlace> places = mesh->places(threshold, context);
      sample.insert(sample.end(), places.begin(), places.end());
    }
    if (sample.size() >= wanted || threshold == kAll) break;
    threshold = mesh == nullptr || threshold > kAll / kWider ? kAll : kWider * threshold;
  }
  const auto before = [](const SampledPlace& a, const SampledPlace& b) {
    return a.key != b.key ? a.key < b.key : a.place < b.place;
  };
  if (wanted < sample.size()) {
    std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(wanted), sample.end(), before);
    sample.resize(static_cast<std::size_t>(wanted));
  }
  const auto per_block = static_cast<float>(1 / (8 * lattice.spacing_m));
  for (SampledPlace& c : sample) {
    const auto row = static_cast<std::uint64_t>(std::clamp(c.place[1] * per_block, 0.0F, 1e9F));
    // Non-negative floats sort like their bits.
    c.key = row << 32 | std::uint64_t{std::bit_cast<std::uint32_t>(std::max(c.place[0], 0.0F))};
  }
  std::sort(sample.begin(), sample.end(), before);
  std::vector<Place> places;
  places.reserve(sample.size());
  for (const SampledPlace& c : sample) places.push_back(c.place);
  return places;
}

std::vector<float> distances_to_surface(const scene::DepthGrid& grid, const std::vector<Place>& sample,
                                        CheckResult& result, ThreadPool& pool) {
  const SurfaceIndex surface(grid);
  std::vector<float> signed_m(sample.size());
  const std::size_t stride = std::max<std::size_t>(1, sample.size() / kSecondMethodSamples);
  const std::size_t pieces = (sample.size() + kSamplesPerPiece - 1) / kSamplesPerPiece;
  std::vector<std::uint64_t> judged(pieces);
  std::vector<double> worst(pieces);
  pool.for_ranges(sample.size(), kSamplesPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Place& p = sample[k];
      const SurfaceDistance found = surface.distance(p[0], p[1], p[2]);
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
NodeErrors error_map(const scene::Lattice& lattice, const std::vector<Place>& sample,
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
  NodeErrors errors;
  std::size_t here = 0;
  for (std::size_t h = 0; h < hits.size(); ++h) {
    const auto [n, k] = hits[h];
    const float distance = std::abs(signed_m[k]);
    if (h > 0 && hits[h - 1].first == n) {
      float& mean = errors.error_m.back();
      mean = mean + (distance - mean) / static_cast<float>(++here);
      continue;
    }
    here = 1;
    errors.node.push_back(n);
    errors.error_m.push_back(distance);
  }
  return errors;
}

/// A sample of the measured nodes (0 = all), ascending, and how many there are.
std::vector<std::uint64_t> sample_nodes(const scene::DepthGrid& grid, std::uint64_t wanted, std::uint64_t& measured) {
  measured = static_cast<std::uint64_t>(std::count(grid.state.begin(), grid.state.end(), scene::NodeState::measured));
  return choose_sample(measured, wanted, [&](const auto& offer) {
    for (std::size_t n = 0; n < grid.state.size(); ++n)
      if (grid.state[n] == scene::NodeState::measured) offer(hash_word(n), n);
  });
}

/// Signed distance from each node to the nearest of the points and triangles, positive when that is nearer to the
/// viewer.
std::vector<float> distances_from_nodes(const scene::DepthGrid& grid, const std::vector<std::uint64_t>& nodes,
                                        const CountedPoints& points, const SeenMesh* mesh, double point_spacing_m,
                                        ThreadPool& pool) {
  if (mesh == nullptr && points.size == 0) return {};
  std::vector<float> distances = nearest_point_distances(grid, nodes, points, point_spacing_m, pool);
  if (mesh == nullptr) return distances;
  const auto nx = static_cast<std::uint64_t>(grid.lattice.nx);
  pool.for_ranges(nodes.size(), kSamplesPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double x = static_cast<double>(nodes[k] % nx) * grid.lattice.spacing_m;
      const double y = static_cast<double>(nodes[k] / nx) * grid.lattice.spacing_m;
      const auto found = static_cast<float>(mesh->triangles().signed_distance(x, y, grid.height_m[nodes[k]]));
      if (std::abs(found) <= std::abs(distances[k])) distances[k] = found;
    }
  });
  return distances;
}

CheckResult compare(const CountedPoints& points, const SeenMesh* mesh, const scene::DepthGrid& grid, double noise_m,
                    double point_spacing_m, const std::optional<scene::FillConfig>& fill,
                    const scene::CheckConfig& config, const Context& context) {
  const scene::Lattice& lattice = grid.lattice;
  const auto wanted = static_cast<std::uint64_t>(std::max<std::int64_t>(0, config.samples));
  CheckResult result;
  using Against = CheckResult::Against;
  if (mesh != nullptr) result.against = points.size == 0 ? Against::mesh : Against::mesh_and_points;
  // A noise of more than half the distance between points cannot be right, and must not excuse the surface.
  result.tolerance_m = std::max(lattice.spacing_m, 3 * std::min(noise_m, 0.5 * point_spacing_m));

  context.progress.at(0.1);
  const std::vector<Place> sample = sample_places(points, mesh, grid, wanted, context);
  context.progress.at(0.3);
  std::vector<float> distances = distances_to_surface(grid, sample, result, context.pool);
  // A grid without a single cell has no surface to be distant from.
  if (!distances.empty() && std::isinf(distances.front()))
    distances.clear();
  else
    result.node_errors = error_map(lattice, sample, distances);
  // However many places of a mesh are taken, there are more between them.
  const std::uint64_t population = mesh == nullptr ? points.size : std::numeric_limits<std::uint64_t>::max();
  result.cloud_to_surface = statistics_of(distances, population);
  result.histogram_bin_m = kHistogramReach * result.cloud_to_surface.p99_m / kBins;
  result.cloud_histogram = histogram_of(distances, result.histogram_bin_m, kBins);
  context.progress.at(0.5);

  std::uint64_t measured = 0;
  const std::vector<std::uint64_t> nodes = sample_nodes(grid, wanted, measured);
  distances = distances_from_nodes(grid, nodes, points, mesh, point_spacing_m, context.pool);
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

}  // namespace

const char* words_of(CheckResult::Against against) {
  switch (against) {
    case CheckResult::Against::mesh:
      return "the mesh";
    case CheckResult::Against::mesh_and_points:
      return "the mesh and the points";
    case CheckResult::Against::points:
      break;
  }
  return "the points";
}

std::string half_of(CheckResult::Against against) {
  return std::string("half of ") + words_of(against) + (against == CheckResult::Against::mesh ? " lies" : " lie");
}

CheckResult cross_check(const CountedPoints& points, const scene::DepthGrid& grid, double noise_m,
                        double point_spacing_m, const std::optional<scene::FillConfig>& fill,
                        const scene::CheckConfig& config, const Context& context) {
  return compare(points, nullptr, grid, noise_m, point_spacing_m, fill, config, context);
}

CheckResult cross_check(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Projection& projection,
                        const std::optional<scene::FillConfig>& fill, const scene::CheckConfig& config,
                        const Context& context) {
  std::optional<SeenMesh> mesh;
  if (!cloud.faces.empty()) mesh.emplace(cloud, scan_to_grid, projection, context.pool);
  const BandedPoints points = counted_points(cloud, scan_to_grid, projection,
                                             mesh ? mesh->corners() : std::vector<std::uint8_t>(), context.pool);
  return compare(points.counted(), mesh ? &*mesh : nullptr, projection.grid, projection.noise_m,
                 projection.point_spacing_m, fill, config, context);
}

}  // namespace sparsha::pipeline
