// A closed body lets no ray in: rays from the outer side of a sheet get away, those from its other side do not. From a
// hollow that is open few get away, and from within its wall none; of a sheet that is seen from both sides, as an open
// shell, and of one in a closed hollow, nothing is said.
#include "pipeline/check/sides_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/numbers/groups.h"
#include "pipeline/check/obstacles.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kDirections = 48;
constexpr float kOblique = 0.25F;  // cosine of a ray and the normal, below which it may meet the sheet itself
// Of points that lie anywhere, so few rays find a gap between balls of that radius in spacings, exp(-pi r^2), that even
// where points are one and a half times as far apart 1 in 300 does.
constexpr float kBall = 2.0F;
constexpr float kLift = 2.5F;  // spacings from the sheet to where a ray begins: no ball of its own points, and noise
// Nodes of which rays begin: few are enough where all of a sheet have one side.
constexpr std::size_t kNodes = 6000, kLeastOfSheet = 9, kMostOfSheet = 200;
constexpr double kSeen = 0.005;  // of a side's rays get away: more than find a gap, and the mouth of a vase lets out
constexpr std::uint32_t kFewRays = 8;
constexpr double kClearly = 3.0;  // times as many as from the other side; of half a ball's shell 2.5 times do
// A sheet whose side the scans say: so many places of it, of which so many agree.
constexpr std::uint64_t kFewPlaces = 5;
constexpr double kAgreed = 0.75;
constexpr double kNearSpacings = 2.0;  // of nodes, from a place that a scanner saw
constexpr float kTelling = 0.3F;       // cosine of a normal and the way to the scanner
constexpr double kTogether = 3.0;      // spacings of nodes between the boxes of sheets that are one place

/// Directions all around, evenly: a spiral of the golden angle.
std::array<Vector3f, kDirections> all_around() {
  std::array<Vector3f, kDirections> directions;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t k = 0; k < kDirections; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(kDirections);
    const double around = std::sqrt(1.0 - z * z), angle = turn * static_cast<double>(k);
    directions[k] = Vector3d(around * std::cos(angle), around * std::sin(angle), z).cast<float>();
  }
  return directions;
}

/// What is known of a side of a sheet, or of a node.
struct Rays {
  std::uint32_t sent = 0, away = 0;
  [[nodiscard]] double share() const { return sent > 0 ? static_cast<double>(away) / sent : 0.0; }
  [[nodiscard]] bool open() const { return away >= kFewRays && share() >= kSeen; }
  void add(const Rays& more) {
    sent += more.sent;
    away += more.away;
  }
};

struct Sides {
  Rays front, back;
  std::uint64_t seen_front = 0, seen_back = 0;  ///< places that scanners saw
};

enum class Verdict : std::uint8_t { untold, outwards, inwards };

Verdict verdict_of(const Sides& sides) {
  const double front = sides.front.share(), back = sides.back.share();
  const std::uint64_t seen = sides.seen_front + sides.seen_back;
  const auto mostly = [&](std::uint64_t count) {
    return seen >= kFewPlaces && static_cast<double>(count) >= kAgreed * static_cast<double>(seen);
  };
  // A room is closed, and its surface the inner one: there the scanners tell.
  if (mostly(sides.seen_front)) return Verdict::outwards;
  if (sides.front.open() && front > kClearly * back) return Verdict::outwards;
  if (mostly(sides.seen_back) || (sides.back.open() && back > kClearly * front)) return Verdict::inwards;
  return Verdict::untold;
}

/// Mean distance of the points that lie on the sheets, at least that of the nodes: these stand for their part of the
/// surface.
float unit_of(std::size_t points, const scene::Charts& charts, const ChartNodes& nodes) {
  double area_m2 = 0.0;  // nodes of overlapping charts share it by the squares of their facing
  for (const ChartNode& node : nodes.all()) {
    const scene::SideAxes axes = scene::SideAxes::of(node.side);
    area_m2 += std::abs(static_cast<double>(node.normal[axes.w]));
  }
  area_m2 *= charts.spacing_m * charts.spacing_m;
  const double apart_m = std::sqrt(area_m2 / static_cast<double>(std::max<std::size_t>(1, points)));
  return static_cast<float>(std::max(apart_m, charts.spacing_m));
}

/// The points relative to the charts' origin, and the box of the nodes with room for what begins beside them.
Obstacles obstacles_of(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                       const ChartNodes& nodes, float unit_m) {
  Vector3f low = nodes.all().front().place_m, high = low;
  for (const ChartNode& node : nodes.all()) {
    low = low.cwiseMin(node.place_m);
    high = high.cwiseMax(node.place_m);
  }
  const Vector3f room = Vector3f::Constant((kLift + 2.0F * kBall) * unit_m);
  std::vector<Vector3f> centres(cloud.size());
  const float* xyz = cloud.xyz1();
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Vector3d scan_m = cloud.origin_m + Eigen::Map<const Vector3f>(xyz + 4 * k).cast<double>();
    centres[k] = ((scan_to_grid * scan_m.homogeneous()).head<3>() - charts.origin_m).cast<float>();
  }
  return {std::move(centres), kBall * unit_m, low - room, high + room};
}

/// Numbers of the nodes that rays begin at, evenly from each sheet.
std::vector<std::uint32_t> chosen(const ChartNodes& nodes, std::size_t sheets) {
  const std::size_t of_sheet = std::clamp(kNodes / std::max<std::size_t>(1, sheets), kLeastOfSheet, kMostOfSheet);
  std::vector<std::uint32_t> result;
  for (std::size_t begin = 0; begin < nodes.all().size();) {
    std::size_t end = begin;
    while (end < nodes.all().size() && nodes.all()[end].sheet == nodes.all()[begin].sheet) ++end;
    const std::size_t count = std::min(of_sheet, end - begin);
    for (std::size_t k = 0; k < count; ++k) {
      result.push_back(static_cast<std::uint32_t>(begin + (2 * k + 1) * (end - begin) / (2 * count)));
    }
    begin = end;
  }
  return result;
}

void send_rays(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
               const ChartNodes& nodes, const Context& context, std::vector<Sides>& sheets) {
  const float unit_m = unit_of(cloud.size(), charts, nodes);
  const Obstacles obstacles = obstacles_of(cloud, scan_to_grid, charts, nodes, unit_m);
  const std::array<Vector3f, kDirections> directions = all_around();
  const std::vector<std::uint32_t> numbers = chosen(nodes, sheets.size());
  std::vector<std::array<Rays, 2>> found(numbers.size());  // of front and back
  context.pool.for_ranges(numbers.size(), 16, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t n = begin; n < end; ++n) {
      const ChartNode& node = nodes.all()[numbers[n]];
      for (const Vector3f& direction : directions) {
        const float cosine = direction.dot(node.normal);
        if (std::abs(cosine) < kOblique) continue;
        const float side = cosine > 0.0F ? 1.0F : -1.0F;
        Rays& rays = found[n][cosine > 0.0F ? 0 : 1];
        ++rays.sent;
        rays.away += obstacles.free(node.place_m + side * kLift * unit_m * node.normal, direction) ? 1 : 0;
      }
    }
  });
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    Sides& sheet = sheets[nodes.all()[numbers[n]].sheet];
    sheet.front.add(found[n][0]);
    sheet.back.add(found[n][1]);
  }
}

void ask_scanners(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                  const ChartNodes& nodes, std::vector<Sides>& sheets) {
  const Eigen::Matrix3d of_normals = scan_to_grid.topLeftCorner<3, 3>().inverse().transpose();
  const auto to_charts = [&](const Vector3d& scan_m) -> Vector3d {
    return (scan_to_grid * scan_m.homogeneous()).head<3>() - charts.origin_m;
  };
  for (const Station& station : cloud.stations) {
    for (std::size_t k = 0; k < station.seen_m.size(); ++k) {
      const Vector3d place_m = to_charts(station.seen_m[k]);
      Vector3d towards = to_charts(station.place_m) - place_m;
      if (!station.normals.empty()) towards = of_normals * station.normals[k].cast<double>();
      const ChartNode* node = nodes.nearest(place_m, kNearSpacings, [](const ChartNode&) { return true; });
      if (node == nullptr) continue;
      const float cosine = node->normal.dot(towards.normalized().cast<float>());
      if (std::abs(cosine) < kTelling) continue;
      Sides& sheet = sheets[node->sheet];
      ++(cosine > 0.0F ? sheet.seen_front : sheet.seen_back);
    }
  }
}

/// Boxes of sheets in the scan frame, those that lie together as one.
std::vector<SidesCheck::Place> places_of(const std::vector<bool>& inwards, const Eigen::Matrix4d& scan_to_grid,
                                         const scene::Charts& charts, const ChartNodes& nodes) {
  const Eigen::Matrix4d scan_from_grid = scan_to_grid.inverse();
  std::vector<SidesCheck::Place> boxes(inwards.size());
  for (const ChartNode& node : nodes.all()) {
    if (!inwards[node.sheet]) continue;
    SidesCheck::Place& box = boxes[node.sheet];
    const Vector3d grid_m = node.place_m.cast<double>() + charts.origin_m;
    const Vector3d scan_m = (scan_from_grid * grid_m.homogeneous()).head<3>();
    box.min_m = box.nodes == 0 ? scan_m : Vector3d(box.min_m.cwiseMin(scan_m));
    box.max_m = box.nodes == 0 ? scan_m : Vector3d(box.max_m.cwiseMax(scan_m));
    ++box.nodes;
  }
  const double apart_m =
      kTogether * charts.spacing_m / std::cbrt(std::abs(scan_to_grid.topLeftCorner<3, 3>().determinant()));
  Groups together(boxes.size());
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    for (std::uint32_t b = a + 1; b < boxes.size() && boxes[a].nodes > 0; ++b) {
      if (boxes[b].nodes == 0) continue;
      const Vector3d gap = (boxes[a].min_m - boxes[b].max_m).cwiseMax(boxes[b].min_m - boxes[a].max_m);
      if (gap.maxCoeff() <= apart_m) together.join(a, b);
    }
  }
  std::vector<SidesCheck::Place> places(boxes.size());
  for (std::uint32_t s = 0; s < boxes.size(); ++s) {
    if (boxes[s].nodes == 0) continue;
    SidesCheck::Place& place = places[together.of(s)];
    place.min_m = place.nodes == 0 ? boxes[s].min_m : Vector3d(place.min_m.cwiseMin(boxes[s].min_m));
    place.max_m = place.nodes == 0 ? boxes[s].max_m : Vector3d(place.max_m.cwiseMax(boxes[s].max_m));
    place.nodes += boxes[s].nodes;
  }
  std::erase_if(places, [](const SidesCheck::Place& place) { return place.nodes == 0; });
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.nodes > b.nodes; });
  if (places.size() > SidesCheck::kMostPlaces) places.resize(SidesCheck::kMostPlaces);
  return places;
}

}  // namespace

SidesCheck check_sides(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                       const ChartNodes& nodes, const Context& context) {
  SidesCheck result;
  if (nodes.all().empty()) return result;
  std::vector<Sides> sheets(charts.sheets.size());
  send_rays(cloud, scan_to_grid, charts, nodes, context, sheets);
  ask_scanners(cloud, scan_to_grid, charts, nodes, sheets);
  std::vector<Verdict> verdict(sheets.size());
  std::vector<bool> inwards(sheets.size(), false);
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    verdict[s] = verdict_of(sheets[s]);
    inwards[s] = verdict[s] == Verdict::inwards;
  }
  for (const ChartNode& node : nodes.all()) {
    ++(verdict[node.sheet] == Verdict::untold ? result.untold : result.told);
    result.inwards += inwards[node.sheet] ? 1 : 0;
  }
  result.places = places_of(inwards, scan_to_grid, charts, nodes);
  return result;
}

}  // namespace sparsha::pipeline
