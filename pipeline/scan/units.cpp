#include "pipeline/scan/units.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace sparsha::pipeline {
namespace {

constexpr double kLargestObject_m = 60.0;     // beyond, an object that is not georeferenced is rather in mm
constexpr double kGeoreferenced_m = 10000.0;  // nobody's local coordinates are so far from zero
constexpr double kSmallestObject_m = 0.002;

}  // namespace

std::optional<UnitGuess> doubt_metres(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const double side = (high - low).maxCoeff();
  const double away = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  if (side > kLargestObject_m && away < kGeoreferenced_m) {
    return UnitGuess{LengthUnit::mm, fmt::format("it would be {} long in metres, {} in mm", length_text(side),
                                                 length_text(side * 0.001))};
  }
  if (side > 0.0 && side < kSmallestObject_m) {
    return UnitGuess{LengthUnit::m, fmt::format("it would be only {} long in metres", length_text(side))};
  }
  return std::nullopt;
}

std::optional<UnitGuess> doubt_metres(const PointSample& sample) {
  const std::vector<Eigen::Vector3d> points = sample.points();
  if (points.empty()) return std::nullopt;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = quantile(points, axis, 0.01);
    high[axis] = quantile(points, axis, 0.99);
  }
  return doubt_metres(low, high);
}

std::optional<UnitGuess> guess_unit(const RawScan& scan) {
  if (scan.unit || scan.degrees || scan.points.empty()) return std::nullopt;
  PointSample sample;
  for (const Eigen::Vector3d& point : scan.points) sample.add(point);
  return doubt_metres(sample);
}

void require_lengths(const RawScan& scan, const std::string& file) {
  if (!scan.degrees) return;
  throw input_error(file, "its x and y are degrees of longitude and latitude, its z is a length",
                    "projected coordinates in metres or feet; reproject the scan first");
}

}  // namespace sparsha::pipeline
