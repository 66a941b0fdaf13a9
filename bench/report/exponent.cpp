#include "bench/report/exponent.h"

#include <array>
#include <cmath>

namespace sparsha::bench {
namespace {

/// Two-sided 95 % of Student's t for 1, 2, ... degrees of freedom.
double student(std::size_t freedom) {
  constexpr std::array<double, 10> kT = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  return freedom <= kT.size() ? kT[freedom - 1] : 1.96;
}

}  // namespace

Exponent fit_exponent(const std::vector<double>& counts, const std::vector<double>& seconds, double floor_s) {
  std::vector<double> x, y;
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (seconds[k] >= floor_s && seconds[k] > 0.0) {
      x.push_back(std::log(counts[k]));
      y.push_back(std::log(seconds[k]));
    }
  Exponent fit;
  fit.counts = x.size();
  if (x.size() < 2) return fit;
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0, mean_y = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) mean_x += x[k] / n, mean_y += y[k] / n;
  double xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
  }
  if (!(xx > 0.0)) return {0.0, 0.0, 0};
  fit.value = xy / xx;
  if (x.size() < 3) return fit;
  double residual = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) residual += std::pow(y[k] - mean_y - fit.value * (x[k] - mean_x), 2);
  fit.error = student(x.size() - 2) * std::sqrt(residual / (n - 2.0) / xx);
  return fit;
}

}  // namespace sparsha::bench
