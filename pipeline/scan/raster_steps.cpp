// Histograms of logarithms: what is even fills few of their bins.
#include "pipeline/scan/raster_steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kApart = 8;       // points of a step: coordinates are rounded
constexpr std::size_t kEvery = 17;      // points between steps that are looked at
constexpr double kPerBin = 0.0137;      // between logarithms; the bins go round after a factor of 1.2 million
constexpr std::size_t kSame = 4;        // bins beside each other
constexpr std::uint64_t kFewest = 200;  // steps
constexpr double kMost = 0.5;           // of the steps are the same
constexpr double kClearly = 0.2;        // of the steps, more than of those in metres

// The largest share of the steps that are the same.
template <typename Histogram>
double even_share(const Histogram& histogram) {
  const auto all = std::accumulate(histogram.begin(), histogram.end(), std::uint64_t{0});
  std::uint64_t most = 0;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
    std::uint64_t same = 0;
    for (std::size_t k = 0; k < kSame; ++k) same += histogram[(bin + k) % histogram.size()];
    most = std::max(most, same);
  }
  return all < kFewest ? 0.0 : static_cast<double>(most) / static_cast<double>(all);
}

}  // namespace

void RasterSteps::add(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& place) {
  const auto count = [](Histogram& histogram, double value) {
    const auto bins = static_cast<std::int64_t>(kBins);
    const auto bin = static_cast<std::int64_t>(std::floor(std::log(value) / kPerBin)) % bins;
    ++histogram[static_cast<std::size_t>(bin < 0 ? bin + bins : bin)];
  };
  for (std::size_t k = 0; k + kApart < points.size(); k += kEvery) {
    const Eigen::Vector3d a = points[k] - place;
    const Eigen::Vector3d b = points[k + kApart] - place;
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    const double level = a.head<2>().norm() / a.norm();  // cosine of the elevation
    const double length = (b - a).norm();
    if (!(angle > 0.0 && length > 0.0 && level > 1e-6 && std::isfinite(length))) continue;
    count(angles_, angle);
    count(turns_, angle / level);
    count(lengths_, length);
  }
}

void RasterSteps::add(const RasterSteps& other) {
  for (const auto histogram : {&RasterSteps::angles_, &RasterSteps::turns_, &RasterSteps::lengths_}) {
    for (std::size_t bin = 0; bin < kBins; ++bin) (this->*histogram)[bin] += (other.*histogram)[bin];
  }
}

void RasterSteps::write(MessageWriter& message) const {
  for (const Histogram* const histogram : {&angles_, &turns_, &lengths_}) message.put(*histogram);
}

void RasterSteps::add(MessageReader& message) {
  RasterSteps other;
  for (Histogram* const histogram : {&other.angles_, &other.turns_, &other.lengths_})
    *histogram = message.get<Histogram>();
  add(other);
}

bool RasterSteps::are_even() const {
  const double share = std::max(even_share(angles_), even_share(turns_));
  return share >= kMost && share > even_share(lengths_) + kClearly;
}

}  // namespace sparsha::pipeline
