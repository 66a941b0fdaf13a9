// Points against the nodes that are nearest, and nodes of two sides against each other.
#include "pipeline/check/charts_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/hash.h"
#include "pipeline/check/chart_nodes.h"
#include "pipeline/check/statistics.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kMostNodes = 200000;
constexpr double kSameWay = 0.86602540378;  // cosine of 30 degrees
constexpr double kNearSpacings = 1.5;       // nodes of another side that show the same place

std::uint64_t key_of(const float* xyz) {
  return hash_words(std::array<std::uint64_t, 3>{std::bit_cast<std::uint32_t>(xyz[0]),
                                                 std::bit_cast<std::uint32_t>(xyz[1]),
                                                 std::bit_cast<std::uint32_t>(xyz[2])});
}

std::vector<float> known_of(const std::vector<float>& values) {
  std::vector<float> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](float v) { return std::isfinite(v); });
  return known;
}

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

}  // namespace

ChartCheck check_charts(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                        const scene::CheckConfig& config, const Context& context) {
  const ChartNodes nodes(charts);
  ChartCheck result;
  result.points = cloud.size();
  const float* xyz = cloud.xyz1();
  const std::vector<std::uint64_t> sample = choose_sample(
      cloud.size(), static_cast<std::uint64_t>(std::max<std::int64_t>(0, config.samples)), [&](const auto& offer) {
        for (std::size_t k = 0; k < cloud.size(); ++k) offer(mix_bits(key_of(xyz + 4 * k)), k);
      });
  result.sampled = sample.size();
  std::vector<float> distance_m(sample.size(), kNothing);
  const std::size_t every = sample.size() / kMostNodes + 1;
  result.places.resize((sample.size() + every - 1) / every,
                       {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), kNothing});
  context.pool.for_ranges(sample.size(), 1024, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t s = begin; s < end; ++s) {
      const float* p = xyz + 4 * static_cast<std::size_t>(sample[s]);
      const Vector3d scan_m = cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(p).cast<double>();
      const Vector3d place_m = (scan_to_grid * scan_m.homogeneous()).head<3>() - charts.origin_m;
      const ChartNode* nearest =
          nodes.nearest(place_m, ChartCheck::kFarSpacings, [](const ChartNode&) { return true; });
      if (nearest == nullptr) continue;
      distance_m[s] = nearest->normal.dot((place_m - nearest->place_m.cast<double>()).cast<float>());
      if (s % every == 0) result.places[s / every] = {place_m.cast<float>(), nearest->normal, distance_m[s]};
    }
  });
  std::erase_if(result.places, [](const ChartCheck::Place& place) { return std::isnan(place.distance_m); });
  const std::vector<float> near_m = known_of(distance_m);
  result.far = sample.size() - near_m.size();
  result.cloud_to_surface = statistics_of(near_m, cloud.size());

  const std::size_t step = nodes.all().size() / kMostNodes + 1;
  result.nodes = (nodes.all().size() + step - 1) / step;
  std::vector<float> apart_m(result.nodes, kNothing);
  context.pool.for_ranges(result.nodes, 1024, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t n = begin; n < end; ++n) {
      const ChartNode& node = nodes.all()[n * step];
      const ChartNode* other = nodes.nearest(node.place_m.cast<double>(), kNearSpacings, [&](const ChartNode& o) {
        return o.side != node.side && o.normal.dot(node.normal) >= static_cast<float>(kSameWay);
      });
      if (other == nullptr) continue;
      // Along the mean normal, so that a bend between the two counts for neither.
      apart_m[n] = (node.normal + other->normal).normalized().dot(node.place_m - other->place_m);
    }
  });
  const std::vector<float> agreement_m = known_of(apart_m);
  result.nodes_alone = result.nodes - agreement_m.size();
  result.agreement = statistics_of(agreement_m, result.nodes);
  result.sides = check_sides(cloud, scan_to_grid, charts, nodes, context);
  return result;
}

}  // namespace sparsha::pipeline
