// Two values that rise with a grid are no proof: x and y of a height field do so too. What tells them apart is what
// stands behind: heights and measures of a height field do not grow with its rows and its columns, coordinates do.
#include "pipeline/scan/formats/text/raster_indices.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scan/formats/text/column_shapes.h"

namespace sparsha::pipeline {
namespace {

constexpr double kLargest = 1e5;           // rows or columns of a grid
constexpr std::uint64_t kFewestRows = 30;  // of the table
constexpr std::uint64_t kFewestRuns = 4;
constexpr double kBeside = 0.5;    // mean step over the standard deviation: of unrelated values 1.1
constexpr double kDirected = 0.5;  // way along a run that is not taken back
constexpr double kTrend = 0.8;     // correlation from run to run
constexpr double kFractions = 0.5;

bool is_index(double value) { return value >= 0.0 && value <= kLargest && value == std::floor(value); }

}  // namespace

void RasterIndices::Trend::add(double at, double value) {
  n += 1.0;
  t += at;
  tt += at * at;
  v += value;
  vv += value * value;
  tv += at * value;
}

double RasterIndices::Trend::deviation() const {
  return n > 0.0 ? std::sqrt(std::max(vv / n - (v / n) * (v / n), 0.0)) : 0.0;
}

double RasterIndices::Trend::correlation() const {
  if (n < 2.0) return 0.0;
  const double of_t = std::sqrt(std::max(tt / n - (t / n) * (t / n), 0.0));
  const double both = of_t * deviation();
  return both > 0.0 ? (tv / n - t / n * v / n) / both : 0.0;
}

bool RasterIndices::add(const TableRow& row) {
  if (row.count < kBehind + 3 || !is_index(row.values[0]) || !is_index(row.values[1])) return false;
  const std::array<double, 2> here = {row.values[0], row.values[1]};
  if (rows_ > 0) {
    const double along = here[fast_] - last_[fast_];
    const double across = here[1 - fast_] - last_[1 - fast_];
    if (across != 0.0) {
      if (across * slow_sign_ < 0.0) return false;
      slow_sign_ = across;
      end_run();
    } else if (along == 0.0 || along * sign_of_run_ < 0.0) {
      return false;
    } else {
      sign_of_run_ = along;
    }
  }
  last_ = here;
  ++rows_;
  const Three point = {row.values[2], row.values[3], row.values[4]};
  const bool finite = std::all_of(point.begin(), point.end(), [](double v) { return std::isfinite(v); });
  if (finite && point != Three{}) measure(here[fast_], point);
  return true;
}

void RasterIndices::measure(double at, const Three& absolute) {
  if (!has_origin_) origin_ = absolute;  // far from 0 squares would lose the differences
  has_origin_ = true;
  const auto is_share = [](double v) { return v >= 0.0 && v <= 1.0; };
  shares_ = shares_ && is_share(absolute[1]) && is_share(absolute[2]);
  Three point{};
  for (std::size_t k = 0; k < 3; ++k) {
    point[k] = absolute[k] - origin_[k];
    values_[k].add(0.0, point[k]);
    sum_[k] += point[k];
    if (!has_point_) continue;
    const double step = point[k] - point_[k];
    net_[k] += sign_of_run_ < 0.0 ? -step : step;
    way_[k] += std::abs(step);
    if (std::abs(at - at_) == 1.0) steps_[k] += std::abs(step);
  }
  if (has_point_ && std::abs(at - at_) == 1.0) step_count_ += 1.0;
  measured_ += 1.0;
  has_point_ = true;
  at_ = at;
  point_ = point;
}

void RasterIndices::end_run() {
  if (measured_ > 0.0) {
    const double number = last_[1 - fast_];
    for (std::size_t k = 0; k < 3; ++k) {
      means_[k].add(number, sum_[k] / measured_);
      all_net_[k] += net_[k];
      all_way_[k] += way_[k];
    }
  }
  ++runs_;
  sum_ = net_ = way_ = {};
  measured_ = 0.0;
  has_point_ = false;
  sign_of_run_ = 0.0;
}

bool RasterIndices::found() const {
  if (rows_ < kFewestRows || runs_ + 1 < kFewestRuns || step_count_ == 0.0) return false;
  const auto beside = [&](std::size_t k) {
    const double deviation = values_[k].deviation();
    return deviation > 0.0 && steps_[k] / step_count_ <= kBeside * deviation;
  };
  for (std::size_t a = 0; a < 3; ++a) {
    if (!beside(a) || std::abs(all_net_[a]) < kDirected * all_way_[a] || all_way_[a] == 0.0) continue;
    for (std::size_t b = 0; b < 3; ++b) {
      if (shares_ && a + b == 3) continue;  // x, y, z and its place in a picture
      if (b != a && beside(b) && std::abs(means_[b].correlation()) >= kTrend) return true;
    }
  }
  return false;
}

bool may_have_raster_indices(const std::vector<TableRow>& sample, std::size_t usual, std::size_t fast) {
  if (sample.size() < kFewestRows || usual < RasterIndices::kBehind + 3 || !are_rows_alike(sample, usual)) return false;
  if (usual == 6 && look_like_normals(sample, usual, 3)) return false;
  RasterIndices indices(fast);
  std::size_t fractions = 0;
  std::size_t numbers = 0;
  for (const TableRow& row : sample) {
    if (!indices.add(row)) return false;
    const auto is_fraction = [](double v) { return v != std::floor(v); };
    if (!std::isfinite(row.values[3]) || !std::isfinite(row.values[4])) continue;
    ++numbers;
    fractions += is_fraction(row.values[3]) || is_fraction(row.values[4]) ? 1 : 0;
  }
  return fractions > 0 && static_cast<double>(fractions) >= kFractions * static_cast<double>(numbers);
}

}  // namespace sparsha::pipeline
