// Limits, and the sentences that go with them.
#include "pipeline/build/warnings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text/text.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {
namespace {

constexpr double kNoisy = 0.5;        // noise, point spacings
constexpr double kFine = 3.0;         // point spacings a grid spacing
constexpr double kFarNoises = 3.0;    // median distance that noise explains, standard deviations,
constexpr double kFarSpacings = 0.2;  // and what form between nodes and points adds, spacings
constexpr double kDoubtful = 0.01;    // shares of measured nodes
constexpr double kTurnedAway = 0.001;
constexpr double kUnsure = 0.2;
constexpr double kEdgeOn = 0.02;       // share of the points that the view could show or shows edge-on
constexpr double kMostlyEdgeOn = 0.9;  // of the same: nothing is left that speaks for the surface

double edge_on_share(const Projection& projection) {
  const std::uint64_t all = projection.used + projection.outlier + projection.edge_on;
  return all > 0 ? static_cast<double>(projection.edge_on) / static_cast<double>(all) : 0.0;
}

// The filter that takes away most of what is seen edge-on; nothing where that is no plane.
std::string plane_filter(const Projection& projection) {
  const Eigen::Vector3d& n = projection.edge_on_normal;
  if (n.isZero()) return {};
  // Two digits, and no minus before a zero.
  const auto tidy = [](double value) { return std::round(100.0 * value) / 100.0 + 0.0; };
  const double distance_m = std::max(3.0 * projection.noise_m, projection.point_spacing_m);
  return fmt::format("remove_plane: {{normal: [{:.2f}, {:.2f}, {:.2f}], distance_mm: {:.2g}}}", tidy(n.x()),
                     tidy(n.y()), tidy(n.z()), 1e3 * distance_m);
}

}  // namespace

SurfaceDoubts surface_doubts(const Projection& projection, const scene::Lattice& lattice,
                             const std::optional<CheckResult>& check) {
  const bool has_points = !projection.only_mesh;
  const double apart = projection.point_spacing_m;
  SurfaceDoubts doubts;
  // On an object of one side, a node that is so much wider than the points are apart is the mean of so many of them.
  const double times = projection.closed || !(apart > 0.0) ? 1.0 : std::max(1.0, lattice.spacing_m / apart);
  doubts.noisy = has_points && projection.noise_m > kNoisy * apart * times * times;
  doubts.fine = has_points && apart > kFine * lattice.spacing_m;
  doubts.explained_m = kFarNoises * projection.noise_m + kFarSpacings * std::max(apart, lattice.spacing_m);
  if (check && check->cloud_to_surface.samples > 0) {
    doubts.far = has_points && check->cloud_to_surface.median_m > doubts.explained_m;
    doubts.not_theirs = check->cloud_to_surface.median_m > lattice.spacing_m;
  }
  doubts.unproven = check && check->cloud_to_surface.samples == 0;
  doubts.unfacing = has_points && projection.facing_asked && !projection.facing_known;
  return doubts;
}

std::vector<std::string> surface_warnings(const Projection& projection, const scene::Lattice& lattice,
                                          std::uint64_t measured, const std::optional<CheckResult>& check) {
  std::vector<std::string> warnings;
  if (projection.only_mesh || measured == 0) return warnings;
  const double noise = projection.noise_m;
  const double apart = projection.point_spacing_m;
  const auto share = [&](std::uint64_t nodes) { return static_cast<double>(nodes) / static_cast<double>(measured); };
  const SurfaceDoubts doubts = surface_doubts(projection, lattice, check);
  if (doubts.noisy) {
    warnings.push_back(fmt::format(
        "the noise, {}, is more than half the distance between points, {}: forms of that size are not real; use a "
        "larger grid.spacing_mm, align the scans better, or give grid.noise_mm if it is known{}",
        length_text(noise), length_text(apart),
        projection.closed ? "; two faces of a sheet that is hardly thicker than that look the same: crop one away"
                          : ""));
  }
  if (doubts.fine) {
    warnings.push_back(
        fmt::format("the grid is {:.1f} times finer than the points, which are {} apart: it shows nothing more than "
                    "grid.spacing_mm: {:.3g} would",
                    apart / lattice.spacing_m, length_text(apart), 1e3 * apart));
  }
  if (doubts.unproven) {
    warnings.emplace_back(
        "the cross-check had nothing to compare: no four measured nodes lie side by side, so there is no surface to "
        "touch; "
        "use a larger grid.spacing_mm, or points that spread over a surface");
  }
  if (doubts.far) {
    warnings.push_back(fmt::format(
        "{} farther than {} from the surface, and noise explains {}: look at the picture of the "
        "errors in the report; another orientation or a smaller grid.spacing_mm may follow the points better",
        half_of(check->against), length_text(check->cloud_to_surface.median_m), length_text(doubts.explained_m)));
  }
  if (edge_on_share(projection) > kEdgeOn) {
    const std::string filter = plane_filter(projection);
    warnings.push_back(
        fmt::format("{} points ({:.0f} % of those before the surface's back) lie on surfaces that this view shows "
                    "edge-on, {}: they are not visible from here and not judged{}",
                    count_text(projection.edge_on), 100.0 * edge_on_share(projection),
                    filter.empty() ? "as a round wall" : "as a floor",
                    filter.empty() ? "" : fmt::format("; the filter '{}' takes the largest away", filter)));
  }
  if (share(projection.nodes_doubtful) > kDoubtful) {
    warnings.push_back(
        fmt::format("two layers were hard to tell apart at {:.1f} % of the nodes: they are closer than the noise and "
                    "the distance of the points allow; crop one of them away, or scan more densely",
                    100.0 * share(projection.nodes_doubtful)));
  }
  if (share(projection.nodes_turned_away) > kTurnedAway) {
    warnings.push_back(
        fmt::format("through holes in the front the inside of the back is seen at {} nodes ({:.1f} %), which are left "
                    "unknown: scan the front there, or let 'fill' close them",
                    projection.nodes_turned_away, 100.0 * share(projection.nodes_turned_away)));
  }
  for (const std::string& scan : projection.lying_stations) {
    warnings.push_back(
        fmt::format("{}: its points do not face the place where the file says that the scanner stood, so that place is "
                    "not believed; the sides of the surface are told by what is seen from outside",
                    scan));
  }
  for (const std::string& scan : projection.lying_normals) {
    warnings.push_back(
        fmt::format("{}: the normals in the file do not point outwards, so they are not believed; the sides of the "
                    "surface are told by what is seen from outside",
                    scan));
  }
  if (doubts.unfacing) {
    warnings.emplace_back(
        "much of what is seen first seems to face away, so that is not believed: holes in the front may show the back; "
        "look at the object from its scanned side");
  } else if (!projection.closed && share(projection.nodes_unsure) > kTurnedAway) {
    warnings.push_back(fmt::format(
        "{} nodes ({:.1f} %) lie behind what is around them, and nothing tells which way they face: there the back may "
        "show through holes in the front; scans of more sides, or files that say where the scanner stood, tell",
        projection.nodes_unsure, 100.0 * share(projection.nodes_unsure)));
  } else if (projection.closed && share(projection.nodes_unsure) > kUnsure) {
    warnings.push_back(
        fmt::format("which way the surface faces is not known at {:.0f} % of the nodes: a hole in the front may show "
                    "the back there; scans of more sides tell",
                    100.0 * share(projection.nodes_unsure)));
  }
  return warnings;
}

void require_surface_near_points(const Projection& projection, const scene::Lattice& lattice,
                                 const CheckResult& check) {
  const DistanceStatistics& distances = check.cloud_to_surface;
  const std::string plane = plane_filter(projection);
  const std::string filter = plane.empty() ? "" : fmt::format(", the filter '{}'", plane);
  if (edge_on_share(projection) > kMostlyEdgeOn) {
    throw input_error(
        {},
        fmt::format("{:.0f} % of the points lie on surfaces that this view shows edge-on: it shows hardly "
                    "anything of the scan",
                    100.0 * edge_on_share(projection)),
        "another orientation" + filter + "; --force builds it all the same");
  }
  if (distances.samples == 0 || distances.median_m <= lattice.spacing_m) return;
  throw input_error(
      {},
      fmt::format("the surface lies more than a grid spacing ({}) from half of {} ({} in the "
                  "median): it is not theirs",
                  length_text(lattice.spacing_m), words_of(check.against), length_text(distances.median_m)),
      "another orientation" + filter + ", a larger grid.spacing_mm or fewer outliers; --force builds it all the same");
}

std::optional<std::string> doubt_of_mixed(double share) {
  if (!(share > 0.0)) return {};
  return fmt::format(
      "around: {:.2g} % of the surface or more are two layers that are taken for one: the faces of walls thinner than "
      "2.3 point spacings, or scans that do not quite fit each other; the thickness of such a wall is not known, and "
      "what "
      "closes it is made up; scan it with points closer together than a third of its thickness, or fit the scans with "
      "`sparsha register`",
      100.0 * share);
}

std::optional<std::string> doubt_of_sides(const SidesCheck& sides) {
  constexpr double kSome = 0.001;  // at sharp edges up to so many nodes face away
  const std::uint64_t nodes = sides.told + sides.untold;
  if (sides.places.empty() || static_cast<double>(sides.inwards) < kSome * static_cast<double>(nodes)) return {};
  const SidesCheck::Place& largest = sides.places.front();
  return fmt::format(
      "around: {:.2g} % of the surface ({} nodes) faces what the points enclose, most of it between ({:.4g}, {:.4g}, "
      "{:.4g}) and ({:.4g}, {:.4g}, {:.4g}) m in the frame of the scans: a hand comes in there without a force; that "
      "is right only for a room from within, of scans that do not say where they were made from",
      100.0 * static_cast<double>(sides.inwards) / static_cast<double>(nodes), count_text(sides.inwards),
      largest.min_m.x(), largest.min_m.y(), largest.min_m.z(), largest.max_m.x(), largest.max_m.y(), largest.max_m.z());
}

std::optional<std::string> ignored_by_heights(const scene::Config& config) {
  const auto solid = [](const auto& box) { return box.solid_m.has_value(); };
  std::vector<std::string> ignored;
  if (!config.filters.empty()) ignored.emplace_back("filters");
  if (config.around) ignored.emplace_back("around");
  if (config.guide && !config.guide->line_in_space_m.empty()) ignored.emplace_back("the guide's line in space");
  if (std::any_of(config.parts.begin(), config.parts.end(), solid)) ignored.emplace_back("parts in space");
  if (config.audio && std::any_of(config.audio->regions.begin(), config.audio->regions.end(), solid))
    ignored.emplace_back("audio regions in space");
  if (ignored.empty()) return std::nullopt;
  return fmt::format("only heights are built; ignored of the configuration: {}", fmt::join(ignored, ", "));
}

}  // namespace sparsha::pipeline
