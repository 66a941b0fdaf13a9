// Plans: cells across a direction, and at which heights they hold points.
#include "pipeline/orient/room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

constexpr double kCell = 3.0;          // pixels: width of the cells of a plan
constexpr double kRagged = 0.002;      // of the points, beyond the lowest and the highest place
constexpr double kEnds = 0.25;         // of the height: where floor and ceiling are looked for
constexpr double kThickness = 0.04;    // of the height, of a floor or a ceiling
constexpr double kLowest = 10.0;       // pixels: lower than that is a plate
constexpr double kCovered = 0.35;      // of the plan, by a floor or a ceiling
constexpr double kFree = 0.08;         // of the height, between floor or ceiling and what stands in the room
constexpr double kWall = 0.08;         // of the plan's width: nearer to its border are walls
constexpr double kAsFar = 0.9;         // of the plan's reach in a direction
constexpr double kWalled = 0.6;        // of the directions
constexpr double kThings = 0.04;       // of the plan within the walls, over which things stand
constexpr double kSurely = 0.025;      // of the height, that the middle of things lies beside the room's
constexpr double kShown = 0.06;        // of things, see Shown
constexpr double kOpenSide = 0.28;     // of things, from an open side
constexpr double kOneSide = 0.4;       // of what is shown, that no other side balances
constexpr double kMostAside = 0.1;     // of the height; farther aside, things tell no more which direction is up
constexpr double kByThings = 3.0;      // what they tell at most, times what floor and ceiling do
constexpr double kClearlyMore = 0.05;  // of the surface, that another direction's floor and ceiling have more than z's

// Cells of a plan, row by row.
struct Plan {
  int width = 0;
  std::vector<int> cell;     // of each point
  std::vector<bool> filled;  // by any point
  std::size_t count = 0;     // of filled cells

  // Share of the filled cells that points at `low` to `high` cover.
  [[nodiscard]] double covered(const std::vector<double>& heights, double low, double high) const {
    std::vector<bool> layer(filled.size());
    std::size_t cells = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const auto n = static_cast<std::size_t>(cell[i]);
      if (heights[i] < low || heights[i] > high || layer[n]) continue;
      layer[n] = true;
      ++cells;
    }
    return static_cast<double>(cells) / static_cast<double>(count);
  }
};

Plan plan_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  const Eigen::Vector3d u = up.unitOrthogonal();
  const Eigen::Vector3d v = up.cross(u);
  Plan plan;
  plan.width = static_cast<int>(2.0 * object.half / kCell) + 3;
  plan.filled.resize(static_cast<std::size_t>(plan.width) * static_cast<std::size_t>(plan.width));
  const auto place = [&](double along) {
    return std::clamp(static_cast<int>((along + object.half) / kCell) + 1, 0, plan.width - 1);
  };
  for (const Eigen::Vector3d& p : object.points) {
    plan.cell.push_back(place(v.dot(p)) * plan.width + place(u.dot(p)));
    const auto n = static_cast<std::size_t>(plan.cell.back());
    if (!plan.filled[n]) ++plan.count;
    plan.filled[n] = true;
  }
  return plan;
}

// Cells with filled ones all around them to a distance of `reach` cells.
std::vector<bool> within_walls(const Plan& plan, int reach) {
  std::vector<bool> inside = plan.filled;
  for (const int step : {1, plan.width}) {
    const std::vector<bool> before = inside;
    for (std::size_t n = 0; n < inside.size(); ++n) {
      for (int k = -reach; k <= reach && inside[n]; ++k) {
        const std::ptrdiff_t beside = static_cast<std::ptrdiff_t>(n) + static_cast<std::ptrdiff_t>(k) * step;
        inside[n] = beside >= 0 && beside < static_cast<std::ptrdiff_t>(before.size()) &&
                    before[static_cast<std::size_t>(beside)];
      }
    }
  }
  return inside;
}

// The layer of `thickness` between two heights that covers most of the plan.
struct Layer {
  double low = 0.0;
  double covered = 0.0;
};

Layer fullest_layer(const Plan& plan, const std::vector<double>& heights, double from, double to, double thickness) {
  Layer best;
  for (double low = from; low <= to - 0.5 * thickness; low += 0.5 * thickness) {
    const double covered = plan.covered(heights, low, low + thickness);
    if (covered > best.covered) best = {low, covered};
  }
  return best;
}

// Share of the directions about the middle of the plan in which something between `low` and `high` reaches as far as
// the plan: walls, as around a room, and not the neck of a bust.
double walled(const EvenPoints& object, const Eigen::Vector3d& up, const std::vector<double>& heights, double low,
              double high) {
  constexpr std::size_t kSectors = 36;
  const Eigen::Vector3d u = up.unitOrthogonal();
  const Eigen::Vector3d v = up.cross(u);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& p : object.points) middle += Eigen::Vector2d(u.dot(p), v.dot(p));
  middle /= static_cast<double>(object.points.size());
  std::array<double, kSectors> all{};
  std::array<double, kSectors> between{};
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const Eigen::Vector2d d = Eigen::Vector2d(u.dot(object.points[i]), v.dot(object.points[i])) - middle;
    const double turns = std::atan2(d.y(), d.x()) / (2.0 * std::numbers::pi) + 0.5;
    const std::size_t sector = std::min(kSectors - 1, static_cast<std::size_t>(turns * kSectors));
    all[sector] = std::max(all[sector], d.norm());
    if (heights[i] >= low && heights[i] <= high) between[sector] = std::max(between[sector], d.norm());
  }
  std::size_t count = 0;
  for (std::size_t s = 0; s < kSectors; ++s) count += between[s] >= kAsFar * all[s] ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(kSectors);
}

// How well things are seen from outside.
struct Shown {
  double most = 0.0;                                  // the share that the best side shows
  double mean = 0.0;                                  // the share that a side shows on average
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  // the mean of the sides, each of the length of its share

  // Half of a solid is seen from its best side, a third or a fifth on average; a room's walls hide what is in it but
  // for doors and what was not scanned: 0.04 for a real room with many gaps, 0.08 and more for solids
  // (tests/pipeline/orient/room_test.cpp).
  [[nodiscard]] bool of_a_room() const { return most * mean <= kShown; }
  // From before a shrine or a niche 0.29 to 0.49 are seen, and 0.42 to 0.86 of what is shown no other side balances;
  // 0.33 and 0.36 of the room with gaps.
  [[nodiscard]] bool from_one_side() const { return most >= kOpenSide && towards.norm() >= kOneSide * mean; }
};

Shown shown_outside(const EvenPoints& object, std::vector<Eigen::Vector3d> things) {
  EvenPoints of_things = object;
  of_things.points = std::move(things);
  const std::vector<Eigen::Vector3d> sides = sides_all_around();
  Shown shown;
  for (const Eigen::Vector3d& side : sides) {
    const Eigen::Vector3d up = side.unitOrthogonal();
    const double share = seen_share(of_things, picture_from(object, side, up), side, up);
    shown.mean += share / static_cast<double>(sides.size());
    shown.most = std::max(shown.most, share);
    shown.towards += share / static_cast<double>(sides.size()) * side;
  }
  return shown;
}

std::optional<Room> room_along(const EvenPoints& object, const Eigen::Vector3d& up) {
  std::vector<double> heights(object.points.size());
  std::transform(object.points.begin(), object.points.end(), heights.begin(),
                 [&](const Eigen::Vector3d& p) { return up.dot(p); });
  std::vector<double> ranked = heights;
  const double low = quantile(ranked, kRagged);
  const double high = quantile(ranked, 1.0 - kRagged);
  const double height = high - low;
  if (height < kLowest) return std::nullopt;
  const Plan plan = plan_of(object, up);
  const double thickness = std::max(kThickness * height, 1.5);
  const Layer floor = fullest_layer(plan, heights, low - thickness, low + kEnds * height, thickness);
  const Layer ceiling = fullest_layer(plan, heights, high - kEnds * height, high + 0.5 * thickness, thickness);
  if (floor.covered < kCovered || ceiling.covered < kCovered) return std::nullopt;

  const double lowest = floor.low + thickness + kFree * height;
  const double highest = ceiling.low - kFree * height;
  const double middle = 0.5 * (lowest + highest);
  const double band = 0.3 * (highest - lowest);
  if (walled(object, up, heights, middle - band, middle + band) < kWalled) return std::nullopt;

  const int reach = std::max(2, static_cast<int>(kWall * std::sqrt(static_cast<double>(plan.count))));
  const std::vector<bool> inside = within_walls(plan, reach);
  const auto within = static_cast<double>(std::count(inside.begin(), inside.end(), true));
  std::vector<bool> occupied(inside.size());
  std::vector<double> things;
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto n = static_cast<std::size_t>(plan.cell[i]);
    if (!inside[n] || heights[i] < lowest || heights[i] > highest) continue;
    occupied[n] = true;
    things.push_back(heights[i]);
    places.push_back(object.points[i]);
  }
  if (things.empty() || static_cast<double>(std::count(occupied.begin(), occupied.end(), true)) < kThings * within)
    return std::nullopt;
  const Shown shown = shown_outside(object, std::move(places));
  if (!shown.of_a_room()) return std::nullopt;
  Room room{up, floor.covered, ceiling.covered};
  if (shown.from_one_side()) room.open_side = shown.towards.normalized();
  const auto flat = std::count_if(heights.begin(), heights.end(), [&](double h) {
    return (h >= floor.low && h <= floor.low + thickness) || (h >= ceiling.low && h <= ceiling.low + thickness);
  });
  room.share = static_cast<double>(flat) / static_cast<double>(heights.size());
  const double aside = (quantile(things, 0.5) - middle) / height;
  room.by_things = std::abs(aside) > kSurely;
  const double told = std::clamp((std::abs(aside) - kSurely) / (kMostAside - kSurely), 0.0, 1.0);
  room.worth = room.share * (1.0 + kByThings * told);
  if (room.by_things && aside > 0.0) {
    room.up = -up;
    std::swap(room.floor, room.ceiling);
  }
  return room;
}

}  // namespace

std::optional<Room> room_of(const EvenPoints& object, const std::vector<Eigen::Vector3d>& tilted) {
  if (object.points.size() < 4) return std::nullopt;
  std::vector<Eigen::Vector3d> directions = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(),
                                             Eigen::Vector3d::UnitX()};
  directions.insert(directions.end(), tilted.begin(), tilted.end());
  std::optional<Room> best;
  for (const Eigen::Vector3d& up : directions) {
    const std::optional<Room> room = room_along(object, up);
    if (room && (!best || room->worth > best->worth + kClearlyMore)) best = room;
  }
  return best;
}

}  // namespace sparsha::pipeline
