// The front told by triangles, by the scanner's place, by the thinnest direction, else by custom.
#include "pipeline/suggest/view.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/numbers/statistics.h"
#include "pipeline/orient/face.h"
#include "pipeline/orient/side_picture.h"
#include "pipeline/orient/thumbnails.h"
#include "pipeline/suggest/range_image.h"
#include "pipeline/suggest/straight_edges.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kSample = 200'000;  // points of a scan
constexpr double kLevel = 0.5;            // cosine between a horizontal view and up, at most
constexpr double kFlat = 0.3;             // thickness beside width of a relief, at most
constexpr double kAlong = 0.95;           // cosine between a view and an up that is none

/// Thinnest direction, and how thin beside the next one.
struct Thinness {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double flatness = 1.0;
};

Thinness thinness_of(const std::vector<Eigen::Vector3d>& points_m, const InnerBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t inside = 0;
  for (const Eigen::Vector3d& point : points_m) {
    if (!((point.array() >= box.low.array()).all() && (point.array() <= box.high.array()).all())) continue;
    covariance += (point - centre) * (point - centre).transpose();
    ++inside;
  }
  covariance /= std::max<double>(1.0, static_cast<double>(inside));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const double thin = std::max(0.0, axes.eigenvalues()[0]);
  return {axes.eigenvectors().col(0), std::sqrt(thin / std::max(axes.eigenvalues()[1], 1e-300))};
}

constexpr double kAxis_deg = 25.0;  // off which a direction that is roughly known may be

// The coordinate axis within so many degrees, else the direction rounded to three digits.
Eigen::Vector3d snapped(const Eigen::Vector3d& direction, double within_deg = kAxis_deg) {
  const Eigen::Vector3d unit = direction.normalized();
  Eigen::Index axis = 0;
  unit.cwiseAbs().maxCoeff(&axis);
  if (std::abs(unit[axis]) > std::cos(within_deg * std::numbers::pi / 180.0)) {
    Eigen::Vector3d snap = Eigen::Vector3d::Zero();
    snap[axis] = unit[axis] > 0 ? 1.0 : -1.0;
    return snap;
  }
  return rounded_direction(unit);
}

// Ground that was surveyed, whatever its slope: it is seen from above, and north is up.
bool is_ground(const Eigen::Vector3d& look_from, const SeenScans& seen, const InnerBox& box) {
  constexpr double kSite_m = 20.0;  // long, or named by coordinates so many times as far from zero as it is long
  constexpr double kFar = 100.0;
  Eigen::Index axis = 0;
  look_from.cwiseAbs().maxCoeff(&axis);
  const double size_m = (box.high - box.low).norm();
  const double off_m = (0.5 * (box.low + box.high)).norm();
  return axis == 2 && (seen.z_up_format || size_m > kSite_m || off_m > kFar * size_m);
}

// How well the direction of flat points is known: the thicker they are, the more their form turns it.
double known_within_deg(const Thinness& thin, bool ground) {
  constexpr double kLeast_deg = 4.0;  // a wall leans by less
  if (ground) return kAxis_deg;
  return std::clamp(1.2 * thin.flatness * 180.0 / std::numbers::pi, kLeast_deg, kAxis_deg);
}

// Of a place over its distance along the view, within 60 degrees: survey coordinates lie far aside of their zero.
constexpr double kSteepest = 2.0;

bool before_a_lens(const InnerBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  return box.low.z() > 0.1 * (box.high - box.low).norm() && centre.norm() < kSteepest * centre.z();
}

// The up of a camera that looks along z: such frames are right-handed with x to the right, so that y goes down.
constexpr double kFacing = 0.7;

bool is_camera_view(const View& view, const SeenScans& seen, const InnerBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  return !seen.z_up_format && view.look_from.normalized().z() < -kFacing && before_a_lens(box) &&
         origin_is_a_scanner(view.look_from.normalized(), centre, (box.high - box.low).norm());
}

// The sides of what is looked at, found when they are first asked for.
class Object {
 public:
  /// `from_within`: its scanners stood in it.
  Object(const SeenScans& seen, const std::optional<Eigen::Vector3d>& up, bool from_within)
      : seen_(seen), up_(up), from_within_(from_within) {}

  /// Share of it that is seen from that direction: of what was scanned from there alone, nearly all.
  [[nodiscard]] double seen_from(const Eigen::Vector3d& direction) {
    const Eigen::Vector3d look_from = direction.normalized();
    const Eigen::Vector3d up = look_from.unitOrthogonal();
    if (even().points.empty()) return 1.0;
    return seen_share(even(), picture_from(even(), look_from, up), look_from, up);
  }
  /// Does its middle lie nearer to that side than its border, as a face's or a mask's does to its front?
  [[nodiscard]] bool bulges_towards(const Eigen::Vector3d& direction) {
    constexpr double kClearly = 0.05;  // of its half width
    const Eigen::Vector3d towards = direction.normalized();
    std::vector<double> off, sorted;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    const std::vector<Eigen::Vector3d>& points = even().points;
    for (const Eigen::Vector3d& p : points) middle += p / static_cast<double>(points.size());
    for (const Eigen::Vector3d& p : points) off.push_back((p - middle).cross(towards).norm());
    sorted = off;
    if (sorted.size() < 4) return false;
    const double half = value_of_rank(sorted, sorted.size() / 2), most = value_of_rank(sorted, sorted.size() - 1);
    std::array<double, 2> sum{}, count{};  // within and beyond the half
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t beyond = off[k] > half ? 1 : 0;
      sum[beyond] += points[k].dot(towards);
      count[beyond] += 1.0;
    }
    return count[0] > 0.0 && count[1] > 0.0 && sum[0] / count[0] - sum[1] / count[1] > kClearly * most;
  }
  [[nodiscard]] bool one_sided(const Eigen::Vector3d& direction) { return seen_from(direction) >= kOneSided; }
  [[nodiscard]] std::optional<FrontView> front() { return standing() ? find_front(even(), *standing()) : std::nullopt; }
  [[nodiscard]] const std::optional<Standing>& standing() {
    if (standing_) return standing_;
    standing_ = up_ ? Standing{up_->normalized(), "up is as you say"} : standing_of(even(), seen_.z_up_format);
    if (standing_ && from_within_) {
      standing_->room = standing_->from_within = true;
      standing_->face.reset();
    }
    return standing_;
  }
  [[nodiscard]] bool is_room() { return standing() && standing()->room; }
  [[nodiscard]] std::shared_ptr<const EvenPoints> points() { return std::make_shared<const EvenPoints>(even()); }

 private:
  const EvenPoints& even() {
    if (!even_) even_ = even_points(seen_.triangles_m.empty() ? seen_.points_m : seen_.triangles_m);
    return *even_;
  }

  const SeenScans& seen_;
  std::optional<Eigen::Vector3d> up_;
  bool from_within_;
  std::optional<EvenPoints> even_;
  std::optional<Standing> standing_;
};

// Where the scanners stood beside what they saw, unit vectors on average.
struct Stood {
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  // from the points to them
  double within = 0.0;  // and how far that is the direction to the object's middle: -1 all around it, 1 in a room
};

Stood stood(const SeenScans& seen, const InnerBox& box) {
  Stood result;
  if (seen.from_stations.empty()) return result;
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  const double each = 1.0 / static_cast<double>(seen.from_stations.size());
  for (const auto& [point_m, place_m] : seen.from_stations) {
    const Eigen::Vector3d towards = (place_m - point_m).normalized();
    result.towards += each * towards;
    result.within += each * towards.dot((centre - point_m).normalized());
  }
  return result;
}
constexpr double kWithin = 0.5;

// A side that scanners stood on, seen level where it is hardly from above or below.
Eigen::Vector3d levelled(const Eigen::Vector3d& side, bool z_up) {
  constexpr double kHardly = 0.6;
  const Eigen::Vector3d up = z_up ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d unit = side.normalized();
  return std::abs(unit.dot(up)) < kHardly ? (unit - unit.dot(up) * up).normalized() : unit;
}

// A view along `look_from` in which `wish` is up; another direction where that is along it.
Eigen::Vector3d up_in_view(const Eigen::Vector3d& look_from, const std::optional<Eigen::Vector3d>& wish, bool z_up) {
  if (wish && std::abs(look_from.normalized().dot(wish->normalized())) < kAlong) return *wish;
  return customary_up(look_from, z_up);
}

// The side that custom calls the front where form tells none.
View customary_view(bool z_up) {
  View view;
  view.look_from = z_up ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d(0, 0, 1);
  view.up = customary_up(view.look_from, z_up);
  view.reason = fmt::format("{}: its front is a guess, look at it and turn it", customary_standing(z_up).reason);
  return view;
}

// The sides of a solid object, by its own form. What was scanned from one side along an axis is seen along it.
View front_view(Object& object, const std::optional<Eigen::Vector3d>& up, bool z_up, Sides& sides) {
  View guess = customary_view(z_up);
  if (!up && !object.is_room()) {
    if (object.one_sided(guess.look_from)) return guess;
    for (const int axis : {2, 0, 1}) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
      if (!object.one_sided(direction) && !object.one_sided(-direction)) continue;
      guess.look_from = object.bulges_towards(-direction) ? rounded_direction(-direction) : direction;
      guess.up = customary_up(guess.look_from, z_up);
      guess.reason = "nearly all of the surface is seen along this axis of the scan";
      return guess;
    }
  }
  const std::optional<FrontView> front = object.front();
  if (!front) return guess;
  sides.standing = object.standing();
  sides.open = front->open();
  if (sides.open) sides.object = object.points();
  guess.evident = !front->open();
  guess.look_from = rounded_direction(front->look_from);
  guess.up = rounded_direction(front->up);
  guess.reason = front->reason;
  return guess;
}

View guess_view(const SeenScans& seen, const std::optional<Eigen::Vector3d>& up, const InnerBox& box,
                const Thinness& thin, const Stood& scanners, Object& object, Sides& sides) {
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  const double size = (box.high - box.low).norm();
  constexpr double kAgreed = 0.3;  // mean of unit normals
  const Eigen::Vector3d facing = seen.stated / std::max(1.0, seen.records);
  constexpr double kAside = 0.1;  // of a view of flat points, scanners
  const Eigen::Vector3d stood_on = levelled(scanners.towards, seen.z_up_format);
  View guess;
  guess.up.setZero();
  guess.evident = true;
  if (seen.rasters) {
    guess.up = Eigen::Vector3d::UnitY();
    guess.reason = "a grid of heights over x and y is seen from above";
    return guess;
  }
  if (seen.area > 0.0 && seen.facing.norm() > 0.3 * seen.area && object.one_sided(seen.facing)) {
    guess.look_from = snapped(seen.facing);
    guess.reason =
        fmt::format("the triangles face this way ({:.0f} % of the area, net)", 100.0 * seen.facing.norm() / seen.area);
  } else if ((seen.depth_camera_format || seen.range_images) && before_a_lens(box)) {
    guess.look_from = {0, 0, -1};
    guess.up = {0, -1, 0};
    guess.reason = seen.range_images
                       ? "an image of a camera in the origin, whose rays are its raster: x right, y down, "
                         "z away"
                       : "all points lie before the origin along z, as depth cameras see them: x right, "
                         "y down, z away";
    return guess;
  } else if (thin.flatness < kFlat) {
    const bool scanner_side = origin_is_a_scanner(thin.direction, centre, size);
    const double stood_aside = scanners.towards.dot(thin.direction);
    const bool proved = std::abs(stood_aside) > kAside;
    const bool told = proved || std::abs(facing.dot(thin.direction)) > kAgreed;
    const double towards = proved ? stood_aside : facing.dot(thin.direction);
    const Eigen::Vector3d side =
        told ? thin.direction * (towards < 0.0 ? -1.0 : 1.0) : seen_side(thin.direction, centre, size);
    guess.look_from = snapped(side, known_within_deg(thin, is_ground(thin.direction, seen, box)));
    guess.reason =
        fmt::format("the points are flat ({:.0f} % as thick as wide) across this direction{}", 100.0 * thin.flatness,
                    proved         ? ", and the scanners stood on this side"
                    : told         ? ", and their normals face this way"
                    : scanner_side ? ", and the scan's origin lies on this side"
                                   : "");
    sides.other_side = !told && !scanner_side && !is_ground(thin.direction, seen, box);
  } else if (scanners.within > kWithin && scanners.towards.norm() > kAgreed && object.one_sided(stood_on)) {
    guess.look_from = snapped(stood_on);
    guess.reason = "it is hollow on the side on which the scanners stood";
  } else if (facing.norm() > kAgreed && object.one_sided(facing)) {
    guess.look_from = snapped(facing);
    guess.reason = "the points' normals face this way";
  } else if (seen.area == 0.0 && centre.norm() > size && centre.norm() < 100.0 * size && object.one_sided(-centre)) {
    guess.evident = false;  // an origin may be anywhere
    guess.look_from = snapped(-centre);
    guess.reason = "the scan's origin, where scanners stand, lies on this side";
  } else {
    return front_view(object, up, seen.z_up_format, sides);
  }
  if (is_camera_view(guess, seen, box)) {
    guess.up = {0, -1, 0};
    guess.reason += "; all lies before it along z, as cameras have it: x right, y down, z away";
  }
  return guess;
}

// Twice the area of a triangle along its normal.
Eigen::Vector3d area_vector(const RawScan& scan, const std::array<std::uint32_t, 3>& face) {
  const Eigen::Vector3d& a = scan.points[face[0]];
  return (scan.points[face[1]] - a).cross(scan.points[face[2]] - a);
}

// Adds places, one for each equal part of the area, by a low-discrepancy sequence within the triangles.
void spread_over_triangles(const RawScan& scan, double metres, double area, std::vector<Eigen::Vector3d>& places_m) {
  constexpr std::size_t kPlaces = 150'000;
  constexpr double kFirst = 0.7548776662466927;  // 1 / p and 1 / p^2, p^3 = p + 1 (Roberts 2018)
  constexpr double kSecond = 0.5698402909980532;
  if (!(area > 0.0) || !std::isfinite(area)) return;
  const double part = area / static_cast<double>(kPlaces);
  double due = 0.5 * part;
  std::size_t count = 0;
  for (const auto& face : scan.faces) {
    due -= area_vector(scan, face).norm();
    for (; due < 0.0; due += part) {
      ++count;
      const double unit = static_cast<double>(count);
      const double s = std::sqrt(unit * kFirst - std::floor(unit * kFirst));
      const double t = unit * kSecond - std::floor(unit * kSecond);
      places_m.emplace_back(metres * ((1.0 - s) * scan.points[face[0]] + s * (1.0 - t) * scan.points[face[1]] +
                                      s * t * scan.points[face[2]]));
    }
  }
}

}  // namespace

void SeenScans::look_at(const ScanStatistics& file, double metres) {
  const RawScan& scan = file.scan;
  const std::size_t stride = std::max<std::size_t>(1, scan.points.size() / kSample);
  for (std::size_t i = 0; i < scan.points.size(); i += stride) points_m.push_back(scan.points[i] * metres);
  double scan_area = 0.0;
  for (const auto& face : scan.faces) {
    const Eigen::Vector3d normal = area_vector(scan, face);
    facing += normal;
    scan_area += normal.norm();
  }
  area += scan_area;
  if (scan.faces.empty()) {
    const auto points = static_cast<double>(scan.records - scan.invalid);
    stated += points * file.stated_facing;
    records += points;
  }
  spread_over_triangles(scan, metres, scan_area, triangles_m);
  for (const SeenStation& station : file.stations) {
    for (const Eigen::Vector3d& p : station.sample.points())
      from_stations.push_back({p * metres, station.place * metres});
  }
  if (is_z_up(scan.format)) z_up_format = true;
  if (file.has_colours) colours = true;
  range_images = (range_images || !any_) && is_range_image(scan, file.runs);
  rasters = (rasters || !any_) && scan.cell.has_value();
  any_ = true;
  if (scan.format.starts_with("PCD")) depth_camera_format = true;
}

void SeenScans::crop(const scene::CropConfig& box) {
  const auto outside = [&](const Eigen::Vector3d& p) {
    return (p.array() < box.min_m.array()).any() || (p.array() > box.max_m.array()).any();
  };
  std::erase_if(points_m, outside);
  std::erase_if(triangles_m, outside);
  std::erase_if(from_stations, [&](const FromStation& seen) { return outside(seen.point_m); });
}

void SeenScans::take_away(const FloorsAndWalls& around) {
  std::erase_if(points_m, [&](const Eigen::Vector3d& p) { return !around.keeps(p); });
  std::erase_if(from_stations, [&](const FromStation& seen) { return !around.keeps(seen.point_m); });
}

Sides sides_of(const SeenScans& seen, const std::optional<Eigen::Vector3d>& up) {
  const InnerBox box = inner_box(seen.points_m);
  const Thinness thin = thinness_of(seen.points_m, box);
  const Stood scanners = stood(seen, box);
  Object object(seen, up, scanners.within > kWithin);
  Sides sides;
  View guess = guess_view(seen, up, box, thin, scanners, object, sides);
  // Up along the view is no up: what is looked at is then seen from beside.
  if (up && !sides.standing && std::abs(guess.look_from.normalized().dot(up->normalized())) > kAlong)
    guess = front_view(object, up, seen.z_up_format, sides);
  if (!sides.standing && (up || guess.up.isZero())) {
    guess.up = up_in_view(guess.look_from, up, seen.z_up_format);
    if (!up && thin.flatness < kFlat && !is_ground(guess.look_from, seen, box)) {
      if (const auto straight = up_along_edges(seen.points_m, guess.look_from, guess.up)) {
        guess.up = rounded_direction(*straight);
        guess.reason += "; up is along its edges";
      }
    }
  }
  sides.views.push_back(guess);
  const std::optional<Eigen::Vector3d> wish = sides.standing ? std::optional(guess.up) : up;
  const auto add = [&](const Eigen::Vector3d& direction, const Eigen::Vector3d& above, const std::string& reason) {
    View view;
    view.look_from = direction;
    view.up = above;
    view.reason = reason;
    const auto same = [&](const View& v) {
      return v.look_from.normalized().dot(view.look_from.normalized()) > 1.0 - 1e-9;
    };
    view.above = sides.standing && view.look_from.normalized().dot(guess.up.normalized()) > kAlong;
    if (std::none_of(sides.views.begin(), sides.views.end(), same)) sides.views.push_back(view);
  };
  if (sides.standing) {
    // What stands is looked at from around it; from below there is only what it stands on.
    for (const NamedView& side : six_sides(guess.look_from, guess.up)) {
      if (side.name == "bottom") continue;
      // The plan of a room lies as the axes of the scan do: none of its walls is the front.
      const bool plan = side.name == "top" && sides.standing->room;
      add(side.look_from, plan ? customary_up(side.look_from, seen.z_up_format) : side.up,
          fmt::format("its {}", side.name));
    }
    for (const double side : {1.0, -1.0}) {
      for (const int axis : {2, 0, 1}) {
        const Eigen::Vector3d direction = side * Eigen::Vector3d::Unit(axis);
        if (std::abs(direction.dot(guess.up.normalized())) < kLevel)
          add(direction, guess.up, "along an axis of the scan");
      }
    }
    return sides;
  }
  const auto add_snapped = [&](const Eigen::Vector3d& direction, const std::string& reason) {
    const Eigen::Vector3d look_from = snapped(direction);
    add(look_from, up_in_view(look_from, wish, seen.z_up_format), reason);
  };
  for (const double side : {1.0, -1.0}) {
    for (const int axis : {2, 0, 1}) add_snapped(side * Eigen::Vector3d::Unit(axis), "along an axis of the scan");
  }
  for (const double side : {1.0, -1.0})
    add_snapped(side * thin.direction, "along the direction in which the points are thinnest");
  return sides;
}

}  // namespace sparsha::pipeline
