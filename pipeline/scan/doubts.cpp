// One function a doubt. Lengths are in the file's unit, which may not be known.
#include "pipeline/scan/doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/text.h"
#include "pipeline/scan/pieces.h"
#include "pipeline/scan/straight.h"
#include "scene/length_unit.h"

namespace sparsha::pipeline {
namespace {

std::string length_of(const RawScan& scan, double length) {
  return scan.unit ? length_text(length * scene::metres_in(*scan.unit)) : fmt::format("{:.3g} units", length);
}

bool doubt_steps(RawScan& scan, const std::vector<Eigen::Vector3d>& sample, std::uint64_t points,
                 const EachPoint& each) {
  const std::optional<CoarseSteps> coarse = coarse_steps(sample, points, !scan.faces.empty(), each);
  if (!coarse) return false;
  std::string steps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(coarse->step[axis] > 0.0)) continue;
    steps +=
        fmt::format("{}{} in steps of {}", steps.empty() ? "" : ", ", "xyz"[axis], length_of(scan, coarse->step[axis]));
  }
  // Before all others: nothing that is found later can be trusted.
  scan.warnings.insert(
      scan.warnings.begin(),
      fmt::format("coordinates are stored too coarsely for points that are {} apart: {}; what is finer is lost. Export "
                  "the scan {} or in local coordinates near zero",
                  length_of(scan, coarse->apart), steps,
                  coarse->single ? "in double precision" : "with more decimals, in double precision"));
  return true;
}

/// A flat site in degrees: its points would be some micrometres apart, and the whole far from zero.
void doubt_small_and_far(RawScan& scan, double wide, double apart, const std::array<double, 3>& most) {
  constexpr double kNearest = 2e-5;
  constexpr double kFar = 100.0;  // widths
  if (!(apart < kNearest) || !(std::min(most[0], most[1]) > kFar * wide)) return;
  scan.warnings.push_back(fmt::format(
      "x and y may be degrees of longitude and latitude: they lie within 180 and 90, spread over {:.3g} and are {:.2g} "
      "apart; if so, reproject the scan to metres, else give its 'units'",
      wide, apart));
}

void doubt_lengths(RawScan& scan, const std::vector<Eigen::Vector3d>& sample, std::uint64_t points) {
  constexpr double kRefused = 1000.0;  // spreads of x and y that z spreads over
  constexpr double kAway = 20.0;       // the same, from zero: no local coordinates
  if (scan.unit || scan.degrees || sample.empty()) return;
  std::array<double, 3> spread{};
  std::array<double, 3> most{};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = quantile(sample, axis, 0.01);
    const double high = quantile(sample, axis, 0.99);
    spread[static_cast<std::size_t>(axis)] = high - low;
    most[static_cast<std::size_t>(axis)] = std::max(std::abs(low), std::abs(high));
  }
  const double wide = std::max(spread[0], spread[1]);
  if (!(spread[0] > 0.0 && spread[1] > 0.0) || most[0] > 180.0 || most[1] > 90.0) return;
  if (!(std::max(most[0], most[1]) > kAway * wide)) return;
  if (!(spread[2] > kRefused * wide)) {
    doubt_small_and_far(scan, wide, std::sqrt(spread[0] * spread[1] / static_cast<double>(points)), most);
    return;
  }
  scan.degrees = true;
  scan.guessed_degrees = true;
  scan.warnings.push_back(fmt::format(
      "x and y look like degrees of longitude and latitude: they lie within 180 and 90 and spread over {:.3g}, while z "
      "spreads over {:.3g}; reproject the scan to metres, or give its 'units' if all three are lengths",
      wide, spread[2]));
}

bool doubt_line(RawScan& scan, const std::vector<Eigen::Vector3d>& sample, std::uint64_t points) {
  const std::optional<StraightLine> line = straight_line(sample, points);
  if (!line) return false;
  scan.warnings.push_back(described(*line, [&](double length) { return length_of(scan, length); }) +
                          ": there is no surface that could be built");
  return true;
}

void doubt_pieces(RawScan& scan, const std::vector<Eigen::Vector3d>& sample) {
  const std::optional<Pieces> pieces = scan.faces.empty() ? pieces_of_points(sample) : pieces_of_mesh(scan);
  if (!pieces) return;
  scan.pieces = fmt::format(
      "{} separate pieces, the largest {} or more from the others and with {:.3g} % of the points: if the others are "
      "no part of the object, the filter 'keep: {{cluster: largest}}' with a tolerance of {} takes them away",
      pieces->count, length_of(scan, pieces->apart), 100.0 * pieces->largest_share, length_of(scan, pieces->apart));
}

}  // namespace

void add_doubts(RawScan& scan, const PointSample& sample, std::uint64_t points, const EachPoint& each) {
  const std::vector<Eigen::Vector3d> some = sample.points();
  doubt_lengths(scan, some, points);
  if (scan.degrees) return;
  if (doubt_line(scan, some, points)) return;
  // What is rounded to wide steps stands in heaps, which are no pieces.
  if (!doubt_steps(scan, some, points, each)) doubt_pieces(scan, some);
}

void add_doubts(RawScan& scan) {
  PointSample sample;
  for (const Eigen::Vector3d& p : scan.points) sample.add(p);
  add_doubts(scan, sample, scan.points.size(), [&](const auto& use) { use(scan.points); });
}

}  // namespace sparsha::pipeline
