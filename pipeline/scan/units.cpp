#include "pipeline/scan/units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text/text.h"

namespace sparsha::pipeline {
namespace {

constexpr double kLargestObject_m = 60.0;  // beyond, an object that is not georeferenced is rather in mm
constexpr double kLongestInMm = 60000.0;   // an object of more millimetres is as unlikely in these
constexpr double kSmallestObject_m = 0.002;

// Distances from zero, in file units.
constexpr double kLocal = 10000.0;      // nobody's local coordinates in metres lie farther
constexpr double kNational = 100000.0;  // the grids of most countries keep one axis beyond
constexpr double kNoPlace = 1e8;        // beyond all grids on Earth, a zone's number before the easting included

// Two units and how many of the smaller one are in the larger one.
struct UnitPair {
  double times;
  scene::LengthUnit smaller, larger;
  bool side_by_side;  // must be evident from the scans' places
};
constexpr std::array kUnitPairs = {UnitPair{1000.0, scene::LengthUnit::mm, scene::LengthUnit::m, false},
                                   UnitPair{100.0, scene::LengthUnit::cm, scene::LengthUnit::m, true},
                                   UnitPair{10.0, scene::LengthUnit::mm, scene::LengthUnit::cm, true}};

// Whether an object that mm explain lies in a grid of the Earth, by two axes: a time in front of a place is far as
// well.
bool is_no_place(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const double side = (high - low).maxCoeff();
  std::array<double, 3> away{};
  for (int axis = 0; axis < 3; ++axis)
    away[static_cast<std::size_t>(axis)] = std::max(std::abs(low[axis]), std::abs(high[axis]));
  std::sort(away.begin(), away.end());
  return away[2] > kNoPlace && away[1] > 0.1 * kNoPlace && side >= 1e3 * kSmallestObject_m && side < kLongestInMm;
}

double longest(const ScanSize& scan) { return (scan.high - scan.low).maxCoeff(); }

// Whether the boxes come as near to each other as a tenth of the longer one.
bool touch(const ScanSize& a, double scale_a, const ScanSize& b) {
  const double room = 0.1 * std::max(scale_a * longest(a), longest(b));
  return ((scale_a * a.low - b.high).array() <= room).all() && ((b.low - scale_a * a.high).array() <= room).all();
}

std::optional<UnitDifference> difference_of(const ScanSize& large, const ScanSize& small) {
  // A scan of kilometres as a scan of metres has none.
  if (large.has_unit || !(large.apart > 0.0 && small.apart > 0.0 && longest(small) > 0.0)) return std::nullopt;
  for (const UnitPair& pair : kUnitPairs) {
    const auto is_about = [&](double ratio, double factor) {
      return ratio > pair.times / factor && ratio < pair.times * factor;
    };
    const double alike = pair.side_by_side ? 1.5 : 3.0;
    if (!is_about(longest(large) / longest(small), alike)) continue;
    const bool touching = touch(large, 1.0 / pair.times, small);
    if (pair.side_by_side && !touching) continue;
    // A mesh and a cloud, or two scanners, differ in density too.
    const double density = !pair.side_by_side && touching ? 10.0 * alike : alike;
    if (!is_about(large.apart / small.apart, density)) continue;
    if (small.has_unit && pair.larger != scene::LengthUnit::m) continue;  // its lengths are metres
    UnitDifference found;
    found.of_large = pair.smaller;
    found.of_small = pair.larger;
    found.reason = fmt::format(
        "{} is about {:.0f} times as large as {}, and so much farther apart are its points: one seems to be in "
        "{}, "
        "the other in {}; set the 'units' of each",
        large.name, pair.times, small.name, to_string(pair.smaller), to_string(pair.larger));
    return found;
  }
  return std::nullopt;
}

bool is_local(double side, double away) { return away < kLocal || away > kNoPlace || away < 4.0 * side; }

}  // namespace

bool may_be_local(double side, double away) {
  return is_local(side, away) || (away < kNational && away < 200.0 * side);
}

std::optional<UnitGuess> doubt_metres(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const double side = (high - low).maxCoeff();
  const double away = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  const bool no_place = is_no_place(low, high);
  const bool in_mm =
      side > kLargestObject_m && away < kNoPlace && (side < kLongestInMm || away < kLocal) && may_be_local(side, away);
  if (no_place || in_mm) {
    const auto from_zero = [&](double metres) {
      return no_place ? " and " + length_text(away * metres) + " from zero" : std::string();
    };
    return UnitGuess{scene::LengthUnit::mm,
                     fmt::format("it would be {} long{} in metres, {}{} in mm", length_text(side), from_zero(1.0),
                                 length_text(side * 0.001), from_zero(0.001)),
                     !no_place && !is_local(side, away)};
  }
  if (side > 0.0 && side < kSmallestObject_m) {
    return UnitGuess{scene::LengthUnit::m, fmt::format("it would be only {} long in metres", length_text(side))};
  }
  return std::nullopt;
}

std::optional<UnitGuess> doubt_metres(const PointSample& sample) {
  const std::vector<Eigen::Vector3d> points = sample.points();
  if (points.empty()) return std::nullopt;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = coordinate_quantile(points, axis, 0.01);
    high[axis] = coordinate_quantile(points, axis, 0.99);
  }
  return doubt_metres(low, high);
}

std::optional<UnitGuess> guess_unit(const RawScan& scan) {
  if (scan.unit || scan.degrees || scan.points.empty()) return std::nullopt;
  PointSample sample;
  for (const Eigen::Vector3d& point : scan.points) sample.add(point);
  return doubt_metres(sample);
}

ScanSize::ScanSize(std::string file, const std::vector<Eigen::Vector3d>& sample, std::uint64_t points, bool unit)
    : name(std::move(file)), has_unit(unit) {
  if (sample.empty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = coordinate_quantile(sample, axis, 0.01);
    high[axis] = coordinate_quantile(sample, axis, 0.99);
  }
  apart = distance_by_extent(sample, points);
}

std::vector<UnitDifference> differing_units(const std::vector<ScanSize>& scans) {
  std::vector<UnitDifference> found;
  for (std::size_t large = 0; large < scans.size(); ++large) {
    for (std::size_t small = 0; small < scans.size(); ++small) {
      std::optional<UnitDifference> difference = difference_of(scans[large], scans[small]);
      if (!difference) continue;
      difference->large = large;
      difference->small = small;
      found.push_back(std::move(*difference));
    }
  }
  return found;
}

void require_lengths(const RawScan& scan, const std::string& file) {
  if (!scan.degrees) return;
  throw input_error(file,
                    scan.guessed_degrees ? "its x and y look like degrees of longitude and latitude, its z is a length"
                                         : "its x and y are degrees of longitude and latitude, its z is a length",
                    scan.guessed_degrees
                        ? "projected coordinates in metres or feet: reproject the scan first, or give its 'units'"
                        : "projected coordinates in metres or feet; reproject the scan first");
}

}  // namespace sparsha::pipeline
