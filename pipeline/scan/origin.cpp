// Bottom-k sampling (Cohen & Kaplan 2007) by a hash of the coordinates.
#include "pipeline/scan/origin.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sparsha::pipeline {

std::uint64_t PointSample::hash(const Eigen::Vector3d& point) {
  // -0.0 and 0.0 are the same point.
  const std::uint64_t x = std::bit_cast<std::uint64_t>(point.x() + 0.0);
  const std::uint64_t y = std::bit_cast<std::uint64_t>(point.y() + 0.0);
  const std::uint64_t z = std::bit_cast<std::uint64_t>(point.z() + 0.0);
  std::uint64_t h =
      x * 0x9E3779B97F4A7C15ULL ^ std::rotl(y * 0xC2B2AE3D27D4EB4FULL, 23) ^ std::rotl(z * 0x165667B19E3779F9ULL, 41);
  h = (h ^ (h >> 32)) * 0xD6E8FEB86659FD93ULL;
  h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ULL;
  return h ^ (h >> 32);
}

bool PointSample::before(const Entry& a, const Entry& b) {
  if (a.hash != b.hash) return a.hash < b.hash;
  return std::lexicographical_compare(a.point.begin(), a.point.end(), b.point.begin(), b.point.end());
}

void PointSample::keep(std::uint64_t h, const Eigen::Vector3d& point) {
  kept_.push_back({h, point});
  if (kept_.size() < 4 * kSize) return;
  kept_ = smallest();
  const std::uint64_t largest = std::max_element(kept_.begin(), kept_.end(), before)->hash;
  threshold_ = largest == ~std::uint64_t{0} ? largest : largest + 1;  // ties are settled by the coordinates
}

std::vector<PointSample::Entry> PointSample::smallest() const {
  std::vector<Entry> entries = kept_;
  if (entries.size() <= kSize) return entries;
  const auto middle = entries.begin() + static_cast<std::ptrdiff_t>(kSize);
  std::nth_element(entries.begin(), middle, entries.end(), before);
  entries.resize(kSize);
  return entries;
}

double PointSample::quantile(int axis, double rank) const {
  const std::vector<Entry> entries = smallest();
  std::vector<double> values;
  values.reserve(entries.size());
  for (const Entry& entry : entries) values.push_back(entry.point[axis]);
  const auto at = static_cast<std::ptrdiff_t>(std::lround(rank * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

Eigen::Vector3d common_origin(const PointSample& sample) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (sample.empty()) return origin;
  for (int axis = 0; axis < 3; ++axis) origin[axis] = std::round(sample.quantile(axis, 0.5)) + 0.0;
  return origin;
}

}  // namespace sparsha::pipeline
