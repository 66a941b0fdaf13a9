#include "pipeline/orient/face.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "base/error.h"
#include "base/numbers/statistics.h"
#include "pipeline/orient/planes.h"
#include "pipeline/scan/origin.h"

namespace sparsha::pipeline {
namespace {

using Face = scene::OrientationConfig::Face;

constexpr double kFaceThickness = 0.02;  // of the object's size
constexpr double kLeastShare = 0.05;     // of the points, on a plane that is a face
constexpr double kEvidentShare = 0.15;   // of the points, on a plane that is the face without being asked for
constexpr double kMargin = 0.1;          // of the size, around the inner points: corners belong to it
constexpr double kParallel = 0.01;       // sine of an angle
constexpr double kRagged = 0.005;        // of the points, beyond a rectangle around them
constexpr int kTurnSteps = 60;           // either way, from a principal axis
constexpr double kTurnStep = 0.1 * std::numbers::pi / 180.0;
constexpr double kAsLong = 0.95;             // of the longer axis
constexpr double kSurelyHidden = 0.2;        // of a face's cells
constexpr std::array kInner = {0.01, 0.99};  // a far outlier says nothing about the object
// Of a place over its distance along the view, within 60 degrees: survey coordinates lie far aside of their zero.
constexpr double kSteepest = 2.0;

struct Object {
  Eigen::Vector3d low_m, high_m;
  std::vector<Eigen::Vector3d> points_m;  // inside the box, sorted
  [[nodiscard]] Eigen::Vector3d centre_m() const { return 0.5 * (low_m + high_m); }
  [[nodiscard]] double size_m() const { return (high_m - low_m).norm(); }
};

Object object_of(const std::vector<Eigen::Vector3d>& sample_m) {
  Object object;
  if (sample_m.size() < 4) throw Error(ErrorKind::input, {}, "too few points to find a face", "more, or a 'look_from'");
  for (int axis = 0; axis < 3; ++axis) {
    object.low_m[axis] = coordinate_quantile(sample_m, axis, kInner[0]);
    object.high_m[axis] = coordinate_quantile(sample_m, axis, kInner[1]);
  }
  const Eigen::Vector3d margin_m = Eigen::Vector3d::Constant(kMargin * object.size_m());
  object.low_m -= margin_m;
  object.high_m += margin_m;
  for (const Eigen::Vector3d& p : sample_m) {
    if ((p.array() >= object.low_m.array()).all() && (p.array() <= object.high_m.array()).all())
      object.points_m.push_back(p);
  }
  std::sort(object.points_m.begin(), object.points_m.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  if (!(object.size_m() > 0.0) || object.points_m.size() < 4) {
    throw Error(ErrorKind::input, {}, "the points have no extent, so that no face can be found", "a 'look_from'");
  }
  return object;
}

// Principal axes, the thinnest first, and their standard deviations.
struct Axes {
  Eigen::Matrix3d direction;
  Eigen::Vector3d length_m;
};

Axes axes_of(const std::vector<Eigen::Vector3d>& points_m) {
  const auto count = static_cast<double>(points_m.size());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points_m) centre += p - points_m.front();
  centre = points_m.front() + centre / count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points_m) covariance += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance / count);
  return {solver.eigenvectors(), solver.eigenvalues().cwiseMax(0.0).cwiseSqrt()};
}

// 1 when stations saw these points from the normal's side, -1 from the other, 0 when no station says so.
int side_of_stations(const std::vector<Station>& stations, const Eigen::Vector3d& normal, const Eigen::Vector3d& on_m,
                     double thickness_m) {
  std::int64_t votes = 0;
  for (const Station& station : stations) {
    for (std::size_t k = 0; k < station.seen_m.size(); ++k) {
      if (std::abs(normal.dot(station.seen_m[k] - on_m)) > thickness_m) continue;
      const double before =
          station.normals.empty() ? normal.dot(station.place_m - on_m) : normal.dot(station.normals[k].cast<double>());
      votes += before > 0.0 ? 1 : before < 0.0 ? -1 : 0;
    }
  }
  return votes > 0 ? 1 : votes < 0 ? -1 : 0;
}

// 1 when the plane is hidden by other points from behind but not from the normal's side, -1 the other way round, else
// 0.
int side_in_view(const Object& object, const Eigen::Vector3d& normal, const Eigen::Vector3d& on_m, double thickness_m) {
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  // Cells with about eight of the points of a face each.
  const double cell_m = object.size_m() * 4.0 / std::sqrt(static_cast<double>(object.points_m.size()));
  struct Cell {
    bool face = false, before = false, behind = false;
  };
  std::map<std::pair<long, long>, Cell> cells;
  for (const Eigen::Vector3d& p : object.points_m) {
    const Eigen::Vector3d d = p - on_m;
    Cell& cell = cells[{std::lround(u.dot(d) / cell_m), std::lround(v.dot(d) / cell_m)}];
    const double height_m = normal.dot(d);
    if (std::abs(height_m) <= thickness_m)
      cell.face = true;
    else
      (height_m > 0.0 ? cell.before : cell.behind) = true;
  }
  double faces = 0.0;
  double difference = 0.0;
  for (const auto& [place, cell] : cells) {
    if (!cell.face) continue;
    faces += 1.0;
    difference += (cell.behind ? 1.0 : 0.0) - (cell.before ? 1.0 : 0.0);
  }
  return difference > kSurelyHidden * faces ? 1 : difference < -kSurelyHidden * faces ? -1 : 0;
}

// Two directions across the view: the principal axes, turned by a few degrees to the smallest rectangle around the
// points, which tells the edges of a slab better than its moments do.
std::array<Eigen::Vector3d, 2> edges_of(const std::vector<Eigen::Vector3d>& points_m, const Axes& axes,
                                        const Eigen::Vector3d& towards) {
  Eigen::Vector3d u = axes.direction.col(2);
  u = (u - u.dot(towards) * towards).normalized();
  const Eigen::Vector3d v = towards.cross(u);
  std::vector<double> along(points_m.size());
  const auto reach_m = [&](const Eigen::Vector3d& direction) {
    std::transform(points_m.begin(), points_m.end(), along.begin(),
                   [&](const Eigen::Vector3d& p) { return direction.dot(p - points_m.front()); });
    const auto rank = [&](double share) {
      return value_of_rank(along, static_cast<std::size_t>(share * static_cast<double>(along.size() - 1)));
    };
    return rank(1.0 - kRagged) - rank(kRagged);
  };
  std::array<Eigen::Vector3d, 2> best = {u, v};
  double smallest_m2 = std::numeric_limits<double>::infinity();
  for (int step = -kTurnSteps; step <= kTurnSteps; ++step) {
    const double angle = kTurnStep * step;
    const std::array<Eigen::Vector3d, 2> edges = {std::cos(angle) * u + std::sin(angle) * v,
                                                  std::cos(angle) * v - std::sin(angle) * u};
    const double area_m2 = reach_m(edges[0]) * reach_m(edges[1]);
    if (area_m2 >= smallest_m2) continue;
    smallest_m2 = area_m2;
    best = edges;
  }
  return best;
}

Eigen::Vector3d upright(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& towards,
                        const std::optional<Eigen::Vector3d>& up, bool z_up) {
  const Eigen::Vector3d wish = up.value_or(customary_up(towards, z_up)).normalized();
  const Eigen::Vector3d flat = wish - wish.dot(towards) * towards;
  if (!(flat.norm() > kParallel)) {
    throw usage_error("'up' is parallel to the view that 'face' has found", "another direction, or none");
  }
  const Axes axes = axes_of(points_m);
  if (axes.length_m[1] > kAsLong * axes.length_m[2]) return flat.normalized();
  const std::array<Eigen::Vector3d, 2> edges = edges_of(points_m, axes, towards);
  const Eigen::Vector3d& best = edges[std::abs(edges[0].dot(flat)) > std::abs(edges[1].dot(flat)) ? 0 : 1];
  return best.dot(flat) < 0.0 ? Eigen::Vector3d(-best) : best;
}

FoundFace facing(const Eigen::Vector3d& towards, const Eigen::Vector3d& up, double scale, std::string reason) {
  FoundFace found{Eigen::Matrix4d::Identity(), std::move(reason)};
  Eigen::Matrix3d turn;
  turn.row(0) = up.cross(towards);
  turn.row(1) = up;
  turn.row(2) = towards;
  found.scan_to_grid.topLeftCorner<3, 3>() = scale * turn;
  return found;
}

}  // namespace

bool origin_is_a_scanner(const Eigen::Vector3d& direction, const Eigen::Vector3d& centre_m, double size_m) {
  const double before = std::abs(direction.dot(centre_m));
  return before > 0.5 * size_m && before < 100.0 * size_m && centre_m.norm() < kSteepest * before;
}

Eigen::Vector3d seen_side(const Eigen::Vector3d& direction, const Eigen::Vector3d& centre_m, double size_m) {
  const bool flip =
      origin_is_a_scanner(direction, centre_m, size_m) ? direction.dot(centre_m) > 0.0 : direction.sum() < 0.0;
  return flip ? Eigen::Vector3d(-direction) : direction;
}

Eigen::Vector3d customary_up(const Eigen::Vector3d& look_from, bool z_up) {
  const Eigen::Vector3d first = z_up ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d second = z_up ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const double along_first = std::abs(look_from.normalized().dot(first));
  const double along_second = std::abs(look_from.normalized().dot(second));
  // A wall that is turned about the second axis and leans along it by much less stands along that one.
  constexpr double kTurned = 0.15, kPlumb = 0.25;
  const bool plumb = along_first > kTurned && along_second < kPlumb * along_first;
  return along_first < 0.8 && !plumb ? first : second;
}

FoundFace find_face(const FacePoints& points, Face face, const std::optional<Eigen::Vector3d>& up, double scale) {
  const Object object = object_of(points.sample_m);
  const auto turned = [&](Eigen::Vector3d normal, const Eigen::Vector3d& on_m,
                          const std::vector<Eigen::Vector3d>& across_m, bool hides, const std::string& what) {
    const double thickness_m = kFaceThickness * object.size_m();
    int side = side_of_stations(points.stations, normal, on_m, hides ? thickness_m : object.size_m());
    std::string why = "it was seen from this side, as the scans say";
    if (side == 0 && hides) {
      side = side_in_view(object, normal, on_m, thickness_m);
      why = "other points hide it from the other side";
    }
    if (side == 0) {
      const Eigen::Vector3d seen = seen_side(normal, object.centre_m(), object.size_m());
      side = seen.dot(normal) > 0.0 ? 1 : -1;
      why = origin_is_a_scanner(normal, object.centre_m(), object.size_m())
                ? "the scan's origin lies on this side"
                : "which of its sides is the front is a guess: look at it and turn it";
    }
    if (side < 0) normal = -normal;
    return facing(normal, upright(across_m, normal, up, points.z_up), scale, fmt::format("{}; {}", what, why));
  };
  if (face != Face::principal) {
    std::vector<Eigen::Vector3f> unit;
    unit.reserve(object.points_m.size());
    for (const Eigen::Vector3d& p : object.points_m) {
      unit.emplace_back(((p - object.centre_m()) / object.size_m()).cast<float>());
    }
    const std::optional<FacePlane> plane = largest_plane(unit, kFaceThickness);
    const double share =
        plane ? static_cast<double>(plane->inliers.size()) / static_cast<double>(object.points_m.size()) : 0.0;
    if (share >= (face == Face::plane ? kLeastShare : kEvidentShare)) {
      std::vector<Eigen::Vector3d> on_face_m;
      for (const std::size_t i : plane->inliers) on_face_m.push_back(object.points_m[i]);
      return turned(plane->normal, object.centre_m() + object.size_m() * plane->centre, on_face_m, true,
                    fmt::format("the largest flat face, {:.0f} % of the points", 100.0 * share));
    }
    if (face == Face::plane) {
      throw Error(ErrorKind::input, {},
                  fmt::format("there is no flat face: the largest plane holds {:.1f} % of the points", 100.0 * share),
                  "a plane with 5 %, or 'face: principal', or a 'look_from'");
    }
  }
  const Axes axes = axes_of(object.points_m);
  return turned(
      axes.direction.col(0), object.centre_m(), object.points_m, false,
      fmt::format("the broad side, along the direction in which the points are thinnest ({:.0f} % of the next)",
                  100.0 * axes.length_m[0] / std::max(axes.length_m[1], 1e-300)));
}

}  // namespace sparsha::pipeline
