// Planes by sample consensus (pipeline/orient/planes.h), largest first; then what they leave over is looked at.
#include "pipeline/suggest/floors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/error.h"
#include "base/numbers/statistics.h"
#include "base/text/text.h"
#include "base/yaml/yaml.h"
#include "base/yaml/yaml_text.h"
#include "pipeline/filter/plane.h"
#include "pipeline/orient/planes.h"
#include "pipeline/suggest/group.h"
#include "pipeline/suggest/inner_box.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kMostPlanes = 8;
constexpr std::size_t kFewest = 200;      // points: fewer are no scan of an object on a floor
constexpr double kTolerance = 0.006;      // of the longest side, when planes are looked for
constexpr double kRough = 0.018;          // the same of a lawn, whose points have no normals at a finer scale
constexpr double kLeastShare = 0.06;      // of the surface, of a floor or a wall
constexpr double kMostBeyond = 0.03;      // of the other points, on the far side of it
constexpr double kReach = 1.25;           // of a plane over what stands before it, along one of its directions
constexpr double kStandsOut = 0.2;        // of the rest's width along the plane, across it
constexpr double kLeastRest = 0.02;       // of the surface
constexpr double kDeviations = 4.0;       // tolerated distance from a plane, standard deviations of its points
constexpr double kNormalAngle_deg = 5.0;  // the filter's max_angle_deg

using Points = std::vector<Eigen::Vector3d>;

struct Candidate {
  Eigen::Vector3d normal;  // towards the others
  double offset_m = 0.0;   // height = normal . p + offset
  double deviation_m = 0.0;
  double tolerance_m = 0.0;
  Points places;

  [[nodiscard]] bool holds(const Eigen::Vector3d& p) const { return std::abs(normal.dot(p) + offset_m) <= tolerance_m; }
};

// The 2nd and the 98th percentile.
std::pair<double, double> ends_along(const Points& points, const Eigen::Vector3d& direction) {
  std::vector<double> places;
  places.reserve(points.size());
  for (const Eigen::Vector3d& p : points) places.push_back(direction.dot(p));
  const double low = quantile(places, 0.02);
  return {low, quantile(places, 0.98)};
}

double extent_along(const Points& points, const Eigen::Vector3d& direction) {
  const auto [low, high] = ends_along(points, direction);
  return high - low;
}

// One point a cube, so that areas count and not densities.
Points spread_evenly(const Points& points, double cube_m) {
  PlaneSample sample(0.5 * cube_m);
  const Eigen::Vector3d& origin = points.front();
  for (const Eigen::Vector3d& p : points) sample.add((p - origin).cast<float>());
  Points even;
  for (const Eigen::Vector3f& p : sample.take()) even.push_back(origin + p.cast<double>());
  return even;
}

std::optional<Candidate> next_plane(const Points& points, double size_m, double tolerance, std::size_t all) {
  if (points.size() < kFewest) return std::nullopt;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) centre += p / static_cast<double>(points.size());
  std::vector<Eigen::Vector3f> scaled;
  scaled.reserve(points.size());
  for (const Eigen::Vector3d& p : points) scaled.push_back(((p - centre) / size_m).cast<float>());
  const std::optional<FacePlane> plane = largest_plane(scaled, tolerance);
  if (!plane || static_cast<double>(plane->inliers.size()) < kLeastShare * static_cast<double>(all))
    return std::nullopt;
  Candidate found;
  found.normal = plane->normal.normalized();
  found.offset_m = -found.normal.dot(centre + size_m * plane->centre);
  for (const std::size_t i : plane->inliers) found.places.push_back(points[i]);
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : found.places) heights.push_back(std::abs(found.normal.dot(p) + found.offset_m));
  constexpr double kNormalMedian = 0.6745;
  found.deviation_m = value_of_rank(heights, heights.size() / 2) / kNormalMedian;
  return found;
}

// Turns the normal towards the others; false when they lie on both sides.
bool bounds(Candidate& plane, const Points& others) {
  std::size_t above = 0;
  std::size_t below = 0;
  for (const Eigen::Vector3d& p : others) {
    const double height = plane.normal.dot(p) + plane.offset_m;
    above += height > plane.tolerance_m ? 1 : 0;
    below += height < -plane.tolerance_m ? 1 : 0;
  }
  if (below > above) {
    plane.normal = -plane.normal;
    plane.offset_m = -plane.offset_m;
    std::swap(above, below);
  }
  return static_cast<double>(below) <= kMostBeyond * static_cast<double>(above + below);
}

// Not what is left of a room: another wall.
bool has_body(const Points& rest) {
  constexpr double kFlat = 0.08;  // standard deviations, the smallest of the largest
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : rest) mean += p / static_cast<double>(rest.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : rest) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  return axes.eigenvalues()[0] > kFlat * kFlat * axes.eigenvalues()[2];
}

bool reaches_beyond(const Candidate& plane, const Points& rest) {
  const Eigen::Vector3d u = plane.normal.unitOrthogonal();
  const Eigen::Vector3d v = plane.normal.cross(u);
  double reach = 0.0;
  double width = 0.0;
  constexpr int kTurns = 8;
  for (int k = 0; k < kTurns; ++k) {
    const double turn = std::numbers::pi * k / kTurns;
    const Eigen::Vector3d direction = std::cos(turn) * u + std::sin(turn) * v;
    const double here = extent_along(rest, direction);
    width = std::max(width, here);
    reach = std::max(reach, extent_along(plane.places, direction) / std::max(1e-9, here));
  }
  return reach >= kReach && extent_along(rest, plane.normal) >= kStandsOut * width;
}

// Does the plane go on well beyond the rest on every side, as a floor or a lawn about a flat stone does, and the floor
// of a room about one of its walls does not?
bool lies_all_about(const Candidate& plane, const Points& rest) {
  constexpr double kBeyond = 0.15;  // of the plane's extent, on either side
  const Eigen::Vector3d u = plane.normal.unitOrthogonal();
  const Eigen::Vector3d v = plane.normal.cross(u);
  constexpr int kTurns = 8;
  for (int k = 0; k < kTurns; ++k) {
    const double turn = std::numbers::pi * k / kTurns;
    const Eigen::Vector3d direction = std::cos(turn) * u + std::sin(turn) * v;
    const auto [low, high] = ends_along(plane.places, direction);
    const auto [first, last] = ends_along(rest, direction);
    if (first - low < kBeyond * (high - low) || high - last < kBeyond * (high - low)) return false;
  }
  return extent_along(rest, plane.normal) >= kStandsOut * (extent_along(rest, u) + extent_along(rest, v));
}

// So far from a plane that few points lie farther and as near again: grass stands higher than noise lies off a floor.
double thickness_of(const Candidate& plane, const Points& points, double size_m) {
  constexpr double kStep = 1.25;
  constexpr double kFew = 0.01;  // of those within
  constexpr double kMost = 4.0;  // tolerances
  std::vector<double> off;
  for (const Eigen::Vector3d& p : points) off.push_back(std::abs(plane.normal.dot(p) + plane.offset_m));
  std::sort(off.begin(), off.end());
  const auto within = [&](double distance_m) {
    return static_cast<double>(std::upper_bound(off.begin(), off.end(), distance_m) - off.begin());
  };
  double thickness_m = std::max(kDeviations * plane.deviation_m, 0.5 * kTolerance * size_m);
  const bool rough = kDeviations * plane.deviation_m >= thickness_m;
  while (rough && kStep * thickness_m <= kMost * kTolerance * size_m &&
         within(2.0 * thickness_m) > (1.0 + kFew) * within(thickness_m))
    thickness_m *= kStep;
  return thickness_m;
}

// Planes with all else before them, and what none of them holds.
std::vector<Candidate> bounding_planes(const Points& even, double size_m, double tolerance, Points& rest) {
  std::vector<Candidate> found;
  Points left = even;
  while (found.size() < kMostPlanes) {
    std::optional<Candidate> plane = next_plane(left, size_m, tolerance, even.size());
    if (!plane) break;
    plane->tolerance_m = thickness_of(*plane, left, size_m);
    std::erase_if(left, [&](const Eigen::Vector3d& p) { return plane->holds(p); });
    found.push_back(std::move(*plane));
  }
  // A floor may go on behind a wall; what counts is what lies on none of them. One that does not bound belongs to the
  // object, and the others are asked again.
  for (;;) {
    rest = even;
    for (const Candidate& plane : found) std::erase_if(rest, [&](const Eigen::Vector3d& p) { return plane.holds(p); });
    if (std::erase_if(found, [&](Candidate& plane) { return !bounds(plane, rest); }) == 0) return found;
  }
}

// Of these the ones that reach beyond what is left, which must be an object.
std::vector<Candidate> planes_about(const Points& even, double size_m, double tolerance, Points& rest) {
  std::vector<Candidate> planes = bounding_planes(even, size_m, tolerance, rest);
  const bool enough = static_cast<double>(rest.size()) >= std::max(50.0, kLeastRest * static_cast<double>(even.size()));
  if (!enough) return {};
  // A flat stone that stands on a lawn, apart from its borders, is no wall of a room.
  const auto about = [&](const Candidate& plane) { return lies_all_about(plane, rest); };
  if (!has_body(rest) && std::none_of(planes.begin(), planes.end(), about)) return {};
  std::erase_if(planes, [&](const Candidate& plane) { return !reaches_beyond(plane, rest); });
  return planes;
}

scene::RemovePlaneConfig filter_of(const Candidate& plane, double size_m) {
  scene::RemovePlaneConfig filter;
  filter.normal = (100.0 * plane.normal).array().round() / 100.0 + 0.0;
  filter.max_angle_deg = kNormalAngle_deg;
  // In whole tenths of a millimetre, or of three digits where that is more.
  const double most_m = std::max(kTolerance * size_m, plane.tolerance_m);
  const double thick_m =
      plane.tolerance_m > 0.5 * kTolerance * size_m ? plane.tolerance_m : kDeviations * plane.deviation_m;
  const double distance_mm = 1e3 * std::clamp(thick_m, 1e-4 * size_m, most_m);
  filter.distance_m = 1e-3 * std::stod(fmt::format("{:.2g}", distance_mm));
  return filter;
}

// False when the filter finds no plane, or another, such as the ceiling.
bool as_a_build_finds_it(const Points& points, const Candidate& candidate, FloorsAndWalls::Plane& plane,
                         const Context& context) {
  const Eigen::Vector3d& origin = points.front();
  PlaneSample sample(plane.filter.distance_m);
  for (const Eigen::Vector3d& p : points) sample.add((p - origin).cast<float>());
  try {
    const PlaneCut cut = find_plane(sample, plane.filter, context).cut;
    plane.normal = cut.normal;
    plane.offset_m = cut.distance_m - cut.offset_m + cut.normal.dot(origin);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    return false;
  }
  const double at_m = -candidate.offset_m;  // along its normal
  return plane.normal.dot(candidate.normal) > 0.99 && std::abs(plane.offset_m - at_m) < 4.0 * plane.filter.distance_m;
}

// The object alone, where strays of what was around it lie apart from it.
std::optional<FloorsAndWalls::Piece> piece_of(const Points& left) {
  constexpr double kMost = 0.7;      // of the points: less is no object and its strays
  constexpr double kCells = 32.0;    // along the object
  constexpr double kNarrower = 0.9;  // of the whole width along some axis: else nothing is gained
  const InnerBox box = inner_box(left);
  const double apart_m = (box.high - box.low).maxCoeff() / kCells;
  if (!(apart_m > 0.0)) return std::nullopt;
  const PointGroup group = largest_piece(left, apart_m);
  Eigen::Vector3d low = left.front();
  Eigen::Vector3d high = left.front();
  for (const Eigen::Vector3d& p : left) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Array3d narrower = (group.crop.max_m - group.crop.min_m).array() / (high - low).array().max(1e-9);
  if (group.share < kMost || group.share == 1.0 || narrower.minCoeff() > kNarrower) return std::nullopt;
  FloorsAndWalls::Piece piece;
  piece.filter.tolerance_m = 1e-3 * std::stod(fmt::format("{:.2g}", 1e3 * apart_m));
  piece.box = group.crop;
  piece.share = group.share;
  return piece;
}

std::string reason_of(const Candidate& plane, const Points& points, double share) {
  // Which way is up nobody knows here; a wall is as likely as a floor.
  const double size_m = extent_along(points, plane.normal);
  return fmt::format(
      "a plane with all else on one side of it, as a floor or a wall: {:.0f} % of the points; what "
      "stands before it reaches {} from it",
      100.0 * share, length_text(size_m));
}

}  // namespace

bool FloorsAndWalls::keeps(const Eigen::Vector3d& point_m) const {
  const auto before = [&](const Plane& plane) { return plane.normal.dot(point_m) > plane.offset_m; };
  const auto in_box = [&](const scene::CropConfig& box) {
    return (point_m.array() >= box.min_m.array()).all() && (point_m.array() <= box.max_m.array()).all();
  };
  return std::all_of(planes.begin(), planes.end(), before) && (!piece || in_box(piece->box));
}

std::string to_text(const FloorsAndWalls& around, const std::string& begin) {
  std::string text;
  for (const FloorsAndWalls::Plane& plane : around.planes) {
    const Eigen::Vector3d& n = plane.filter.normal;
    text += fmt::format(
        "{}remove_plane: {{normal: [{:g}, {:g}, {:g}], distance_mm: {:.3g}, max_angle_deg: {:g}}}  # {}\n", begin,
        n.x(), n.y(), n.z(), 1e3 * plane.filter.distance_m, plane.filter.max_angle_deg, yaml::comment(plane.reason));
  }
  if (around.piece) {
    text += fmt::format("{}keep: {{tolerance_mm: {:.3g}}}  # the largest piece of what is left: {:.1f} % of it\n",
                        begin, 1e3 * around.piece->filter.tolerance_m, 100.0 * around.piece->share);
  }
  return text;
}

FloorsAndWalls find_floors_and_walls(const std::vector<Eigen::Vector3d>& points_m, const Context& context) {
  if (points_m.size() < kFewest) return {};
  const InnerBox box = inner_box(points_m);
  const double size_m = (box.high - box.low).maxCoeff();
  if (!(size_m > 0.0)) return {};
  constexpr double kCube = 1.0 / 96.0;
  const Points even = spread_evenly(points_m, kCube * size_m);
  Points rest;
  std::vector<Candidate> planes = planes_about(even, size_m, kTolerance, rest);
  if (planes.empty()) {
    planes = planes_about(even, size_m, kRough, rest);
    // What is so thick is taken for a lawn only where it lies on all sides of what stands on it.
    std::erase_if(planes, [&](const Candidate& plane) { return !lies_all_about(plane, rest); });
  }

  FloorsAndWalls result;
  Points left = points_m;
  for (const Candidate& candidate : planes) {
    context.progress.throw_if_cancelled();
    FloorsAndWalls::Plane plane;
    plane.filter = filter_of(candidate, size_m);
    if (!as_a_build_finds_it(left, candidate, plane, context)) continue;
    Points after = left;
    std::erase_if(after, [&](const Eigen::Vector3d& p) { return plane.normal.dot(p) <= plane.offset_m; });
    const auto all = static_cast<double>(points_m.size());
    if (static_cast<double>(after.size()) < kLeastRest * all) continue;
    plane.share = static_cast<double>(left.size() - after.size()) / all;
    plane.reason = reason_of(candidate, rest, plane.share);
    left = std::move(after);
    result.planes.push_back(std::move(plane));
  }
  if (!result.planes.empty()) result.piece = piece_of(left);
  return result;
}

}  // namespace sparsha::pipeline
