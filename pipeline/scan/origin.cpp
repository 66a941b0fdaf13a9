// Bottom-k sampling (Cohen & Kaplan 2007) by a hash of the coordinates.
#include "pipeline/scan/origin.h"

#include <algorithm>
#include <cmath>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {

bool PointSample::before(const Entry& a, const Entry& b) {
  if (a.hash != b.hash) return a.hash < b.hash;
  if (a.point != b.point) {
    return std::lexicographical_compare(a.point.begin(), a.point.end(), b.point.begin(), b.point.end());
  }
  return std::lexicographical_compare(a.normal.begin(), a.normal.end(), b.normal.begin(), b.normal.end());
}

void PointSample::keep(const Entry& entry) {
  kept_.push_back(entry);
  if (kept_.size() < 2 * size_) return;
  kept_ = smallest();
  const std::uint64_t largest = std::max_element(kept_.begin(), kept_.end(), before)->hash;
  threshold_ = largest == ~std::uint64_t{0} ? largest : largest + 1;  // ties are settled by the coordinates
}

std::vector<PointSample::Entry> PointSample::smallest() const {
  std::vector<Entry> entries = kept_;
  if (entries.size() <= size_) return entries;
  const auto middle = entries.begin() + static_cast<std::ptrdiff_t>(size_);
  std::nth_element(entries.begin(), middle, entries.end(), before);
  entries.resize(size_);
  return entries;
}

void PointSample::write(MessageWriter& message) const {
  const std::vector<Entry> entries = smallest();
  message.put(std::uint64_t{entries.size()});
  for (const Entry& entry : entries) {
    message.put(entry.hash);
    for (const double coordinate : entry.point) message.put(coordinate);
    for (const float coordinate : entry.normal) message.put(coordinate);
  }
}

void PointSample::add(MessageReader& message) {
  const auto entries = message.get<std::uint64_t>();
  for (std::uint64_t k = 0; k < entries; ++k) {
    Entry entry{message.get<std::uint64_t>(), Eigen::Vector3d::Zero(), Eigen::Vector3f::Zero()};
    for (double& coordinate : entry.point) coordinate = message.get<double>();
    for (float& coordinate : entry.normal) coordinate = message.get<float>();
    if (entry.hash < threshold_) keep(entry);
  }
}

std::vector<Eigen::Vector3d> PointSample::points() const {
  std::vector<Eigen::Vector3d> points;
  for (const Entry& entry : smallest()) points.push_back(entry.point);
  return points;
}

std::vector<Eigen::Vector3f> PointSample::normals() const {
  std::vector<Eigen::Vector3f> normals;
  for (const Entry& entry : smallest()) normals.push_back(entry.normal);
  return normals;
}

double coordinate_quantile(const std::vector<Eigen::Vector3d>& points, int axis, double rank) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& p : points) values.push_back(p[axis]);
  return value_of_rank(values, static_cast<std::size_t>(std::lround(rank * static_cast<double>(values.size() - 1))));
}

double distance_by_extent(const std::vector<Eigen::Vector3d>& sample, std::uint64_t points) {
  constexpr double kThinnest = 1e-3;  // of the longest side
  std::array<double, 3> side{};
  for (int axis = 0; axis < 3; ++axis)
    side[static_cast<std::size_t>(axis)] =
        coordinate_quantile(sample, axis, 0.99) - coordinate_quantile(sample, axis, 0.01);
  std::sort(side.begin(), side.end());
  const double area = side[2] * std::max(side[1], kThinnest * side[2]);
  return std::sqrt(area / static_cast<double>(std::max<std::uint64_t>(1, points)));
}

Eigen::Vector3d common_origin(const PointSample& sample) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const std::vector<Eigen::Vector3d> points = sample.points();
  if (points.empty()) return origin;
  for (int axis = 0; axis < 3; ++axis) origin[axis] = std::round(coordinate_quantile(points, axis, 0.5)) + 0.0;
  return origin;
}

}  // namespace sparsha::pipeline
