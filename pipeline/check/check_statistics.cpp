// Plain two-pass statistics; a sample fits in memory.
#include "pipeline/check/check_statistics.h"

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {
namespace {

constexpr double kNormal95 = 1.959963984540054;  // half width of the central 95 % of a normal distribution, sigmas

double rank(std::vector<double>& values, double fraction) {
  const auto n = static_cast<double>(values.size());
  const auto nth = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(fraction * n) - 1, 0.0, n - 1));
  std::nth_element(values.begin(), values.begin() + nth, values.end());
  return values[static_cast<std::size_t>(nth)];
}

}  // namespace

DistanceStatistics statistics_of(const std::vector<float>& signed_m, std::uint64_t population) {
  DistanceStatistics result;
  result.samples = signed_m.size();
  if (signed_m.empty()) return result;
  const auto n = static_cast<double>(signed_m.size());
  std::vector<double> distance;
  distance.reserve(signed_m.size());
  double sum = 0, signed_sum = 0, squares = 0;
  for (const float value : signed_m) {
    const double d = std::abs(static_cast<double>(value));
    distance.push_back(d);
    sum += d;
    signed_sum += value;
    squares += d * d;
    result.max_m = std::max(result.max_m, d);
  }
  result.mean_m = sum / n;
  result.signed_mean_m = signed_sum / n;
  result.rms_m = std::sqrt(squares / n);
  result.p99_m = rank(distance, 0.99);
  result.p95_m = rank(distance, 0.95);
  result.median_m = rank(distance, 0.5);
  double spread = 0;
  for (double& d : distance) {
    spread += (d - result.mean_m) * (d - result.mean_m);
    d = std::abs(d - result.median_m);
  }
  result.mad_m = rank(distance, 0.5);
  if (population > result.samples && result.samples > 1) {
    const double all = static_cast<double>(population);
    result.mean_ci95_m = kNormal95 * std::sqrt(spread / (n - 1) / n * (1 - n / all));
  }
  return result;
}

std::vector<std::uint64_t> histogram_of(const std::vector<float>& signed_m, double bin_m, int bins) {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(bins));
  if (!(bin_m > 0)) return counts;
  for (const float value : signed_m) {
    const double bin = std::abs(static_cast<double>(value)) / bin_m;
    if (bin < bins) ++counts[static_cast<std::size_t>(bin)];
  }
  return counts;
}

std::vector<std::uint32_t> choose_sample(const std::vector<std::uint64_t>& keys, std::uint64_t wanted) {
  std::vector<std::uint32_t> chosen;
  const bool all = wanted == 0 || wanted >= keys.size();
  // Hashes are uniform: a threshold a little above the wanted share keeps most keys out of the selection.
  std::uint64_t threshold = ~std::uint64_t{0};
  if (!all) {
    const double share = (static_cast<double>(wanted) + 6 * std::sqrt(static_cast<double>(wanted)) + 6) /
                         static_cast<double>(keys.size());
    if (share < 1) threshold = static_cast<std::uint64_t>(share * 0x1p64);
  }
  const auto collect = [&] {
    chosen.clear();
    for (std::size_t n = 0; n < keys.size(); ++n)
      if (keys[n] <= threshold) chosen.push_back(static_cast<std::uint32_t>(n));
  };
  collect();
  if (all) return chosen;
  if (chosen.size() < wanted) {
    threshold = ~std::uint64_t{0};
    collect();
  }
  std::nth_element(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(wanted), chosen.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
  chosen.resize(wanted);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::uint64_t hash_word(std::uint64_t word) noexcept {
  word += 0x9E3779B97F4A7C15ULL;
  word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9ULL;
  word = (word ^ (word >> 27)) * 0x94D049BB133111EBULL;
  return word ^ (word >> 31);
}

}  // namespace sparsha::pipeline
