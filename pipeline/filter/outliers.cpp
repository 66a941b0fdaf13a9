#include "pipeline/filter/outliers.h"

#include <algorithm>
#include <cmath>

#include "pipeline/filter/neighbour_tree.h"

namespace sparsha::pipeline {
namespace {

__extension__ using Wide = unsigned __int128;

/// Largest distance that is still an inlier's. Sums are integers of 2^-44 of the greatest distance, so that they are
/// the same in every order.
double threshold(const std::vector<float>& distances, double sigma) {
  const double largest = static_cast<double>(*std::max_element(distances.begin(), distances.end()));
  if (!(largest > 0.0)) return 0.0;
  int exponent = 0;
  std::frexp(largest, &exponent);
  const int shift = 44 - exponent;
  Wide sum = 0;
  Wide squares = 0;
  for (const float d : distances) {
    const auto whole = static_cast<std::uint64_t>(std::llround(std::ldexp(static_cast<double>(d), shift)));
    sum += whole;
    squares += static_cast<Wide>(whole) * whole;
  }
  const double n = static_cast<double>(distances.size());
  const double mean = static_cast<double>(sum) / n;
  const double variance = (static_cast<double>(squares) - static_cast<double>(sum) * mean) / (n - 1.0);
  // Where all distances are the same, rounding must not decide.
  constexpr double kSlack = 1.0 + 1e-12;
  return std::ldexp((mean + sigma * std::sqrt(std::max(0.0, variance))) * kSlack, -shift);
}

}  // namespace

std::vector<std::uint8_t> statistical_inliers(const Cloud& cloud, const scene::OutlierConfig& config,
                                              const Context& context) {
  std::vector<std::uint8_t> keep(cloud.size(), 1);
  if (cloud.size() < 2) return keep;
  const NeighbourTree tree(cloud.xyz1(), cloud.size(), context);
  const std::vector<float> distances = tree.mean_distances(config.neighbours, context);
  const double most = threshold(distances, config.sigma);
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = static_cast<double>(distances[i]) <= most ? 1 : 0;
  return keep;
}

}  // namespace sparsha::pipeline
