// One function a doubt. Lengths are in the file's unit, which may not be known.
#include "pipeline/scan/doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "base/text/text.h"
#include "pipeline/scan/pieces.h"
#include "pipeline/scan/straight.h"
#include "pipeline/scan/viewpoint.h"
#include "scene/frame/length_unit.h"

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

struct Spreads {
  std::array<double, 3> spread{};
  std::array<double, 3> most{};  ///< distance from zero
};

Spreads spreads_of(const std::vector<Eigen::Vector3d>& sample) {
  Spreads result;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = coordinate_quantile(sample, axis, 0.01);
    const double high = coordinate_quantile(sample, axis, 0.99);
    result.spread[static_cast<std::size_t>(axis)] = high - low;
    result.most[static_cast<std::size_t>(axis)] = std::max(std::abs(low), std::abs(high));
  }
  return result;
}

/// Two axes as degrees beside a height: they are small, and far from zero for their spread, as no local coordinates
/// are.
bool may_be_degrees(const Spreads& s, std::size_t a, std::size_t b, const std::array<double, 2>& limits) {
  constexpr double kAway = 20.0;  // spreads
  const double wide = std::max(s.spread[a], s.spread[b]);
  return s.spread[a] > 0.0 && s.spread[b] > 0.0 && s.most[a] <= limits[0] && s.most[b] <= limits[1] &&
         std::max(s.most[a], s.most[b]) > kAway * wide;
}

void doubt_lengths(RawScan& scan, const std::vector<Eigen::Vector3d>& sample, std::uint64_t points) {
  constexpr double kRefused = 1000.0;  // spreads of the two that the height spreads over
  if (scan.unit || scan.degrees || sample.empty()) return;
  const Spreads s = spreads_of(sample);
  // A height that stands before the two leaves open which of these is the latitude.
  constexpr double kTurn = 180.0, kRight = 90.0;
  for (const auto& [a, b, height, second] :
       {std::tuple{0U, 1U, 2U, kRight}, {1U, 2U, 0U, kTurn}, {0U, 2U, 1U, kTurn}}) {
    const double wide = std::max(s.spread[a], s.spread[b]);
    if (!may_be_degrees(s, a, b, {kTurn, second}) || !(s.spread[height] > kRefused * wide)) continue;
    scan.degrees = true;
    scan.guessed_degrees = true;
    scan.warnings.push_back(fmt::format(
        "{0} and {1} look like degrees of longitude and latitude: they lie within 180 and 90 and spread over {3:.3g}, "
        "while {2} spreads over {4:.3g}; reproject the scan to metres, or give its 'units' if all three are lengths",
        "xyz"[a], "xyz"[b], "xyz"[height], wide, s.spread[height]));
    return;
  }
  if (!may_be_degrees(s, 0, 1, {kTurn, kRight})) return;
  doubt_small_and_far(scan, std::max(s.spread[0], s.spread[1]),
                      std::sqrt(s.spread[0] * s.spread[1] / static_cast<double>(points)), s.most);
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
  if (scan.viewpoint) {
    if (std::string doubt = viewpoint_doubt(*scan.viewpoint); !doubt.empty()) scan.warnings.push_back(std::move(doubt));
  }
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
