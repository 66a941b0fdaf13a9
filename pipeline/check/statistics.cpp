// Plain two-pass statistics; a sample fits in memory.
#include "pipeline/check/statistics.h"

#include <algorithm>
#include <cmath>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNormal95 = 1.959963984540054;  // half width of the central 95 % of a normal distribution, sigmas

double rank(std::vector<double>& values, double fraction) {
  const auto n = static_cast<double>(values.size());
  return value_of_rank(values, static_cast<std::size_t>(std::clamp(std::ceil(fraction * n) - 1, 0.0, n - 1)));
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

std::uint64_t sample_threshold(std::uint64_t population, std::uint64_t wanted) noexcept {
  const double sample = static_cast<double>(wanted);
  const double share =
      (sample + 6 * std::sqrt(sample) + 6) / static_cast<double>(std::max<std::uint64_t>(1, population));
  return share < 1 ? static_cast<std::uint64_t>(share * 0x1p64) : ~std::uint64_t{0};
}

std::vector<std::uint64_t> smallest_keys(std::vector<Keyed> candidates, std::uint64_t wanted) {
  if (wanted < candidates.size()) {
    std::nth_element(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(wanted), candidates.end(),
                     [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.item < b.item; });
    candidates.resize(wanted);
  }
  std::vector<std::uint64_t> items;
  items.reserve(candidates.size());
  for (const Keyed& candidate : candidates) items.push_back(candidate.item);
  std::sort(items.begin(), items.end());
  return items;
}

}  // namespace sparsha::pipeline
