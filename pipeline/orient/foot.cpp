// Convex hulls of what lies lowest and of all.
#include "pipeline/orient/foot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFootHeight = 0.03;    // of the object's height
constexpr double kRagged = 0.002;       // of the points, beyond its lowest and highest place
constexpr std::size_t kOutline = 4000;  // points that an outline is taken from
constexpr double kFootCell = 3.0;       // pixels: width of the cells by which a foot is filled

using Place = Eigen::Vector2d;

// The convex hull, counterclockwise.
std::vector<Place> hull_of(std::vector<Place> places) {
  if (places.size() < 3) return places;
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  std::vector<Place> hull;
  const auto turns_right = [&](const Place& p) {
    const Place a = hull[hull.size() - 1] - hull[hull.size() - 2];
    const Place b = p - hull[hull.size() - 2];
    return a.x() * b.y() - a.y() * b.x() <= 0.0;
  };
  for (const bool back : {false, true}) {
    const std::size_t begin = hull.size();
    for (const Place& p : places) {
      while (hull.size() >= begin + 2 && turns_right(p)) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    if (!back) std::reverse(places.begin(), places.end());
  }
  return hull;
}

// Twice the area of a convex hull.
double area_of(const std::vector<Place>& hull) {
  double area = 0.0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const Place& a = hull[k];
    const Place& b = hull[(k + 1) % hull.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

std::vector<double> heights_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  std::vector<double> heights(object.points.size());
  std::transform(object.points.begin(), object.points.end(), heights.begin(),
                 [&](const Eigen::Vector3d& p) { return up.dot(p); });
  return heights;
}

// What is seen of it from above.
struct Footprint {
  Footprint(const EvenPoints& object, const Eigen::Vector3d& up) : u(up.unitOrthogonal()), v(up.cross(u)) {
    const auto place = [&](const Eigen::Vector3d& p) { return Place(u.dot(p), v.dot(p)); };
    std::vector<Place> all;
    const std::size_t step = std::max<std::size_t>(1, object.points.size() / kOutline);
    for (std::size_t i = 0; i < object.points.size(); i += step) all.push_back(place(object.points[i]));
    for (const std::size_t i : lowest_of(object, up, kFootHeight)) places.push_back(place(object.points[i]));
    hull = hull_of(places);
    area = area_of(hull);
    outline = area_of(hull_of(std::move(all)));
  }
  [[nodiscard]] double share() const { return outline > 0.0 ? area / outline : 0.0; }

  Eigen::Vector3d u, v;
  std::vector<Place> places;  // of the lowest points
  std::vector<Place> hull;
  double area = 0.0, outline = 0.0;  // twice those of the hulls
};

// Of the triangle between the place below a point and two others on the ground, as that point sees it from so high
// (Van Oosterom and Strackee 1983).
double solid_angle(const Place& a, const Place& b, double height) {
  const double ra = std::hypot(a.norm(), height);
  const double rb = std::hypot(b.norm(), height);
  const double volume = (a.x() * b.y() - a.y() * b.x()) * height;
  const double product =
      ra * height * rb + (a.dot(b) + height * height) * height + height * height * rb + height * height * ra;
  return 2.0 * std::atan2(volume, product);
}

}  // namespace

std::vector<std::size_t> lowest_of(const EvenPoints& object, const Eigen::Vector3d& up, double share) {
  const std::vector<double> heights = heights_of(object, up);
  std::vector<double> ranked = heights;
  const double low = quantile(ranked, kRagged);
  const double limit = low + share * (quantile(ranked, 1.0 - kRagged) - low);
  std::vector<std::size_t> lowest;
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (heights[i] <= limit) lowest.push_back(i);
  return lowest;
}

double foot_of(const EvenPoints& object, const Eigen::Vector3d& up) { return Footprint(object, up).share(); }

Stand stand_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  const Footprint print(object, up);
  Stand stand;
  if (print.hull.size() < 3) return stand;
  stand.foot = print.share();
  const std::vector<double> heights = heights_of(object, up);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : object.points) middle += p;
  middle /= static_cast<double>(object.points.size());
  std::vector<double> ranked = heights;
  const double over = up.dot(middle) - quantile(ranked, kRagged);  // of the middle over the ground
  const Place below(print.u.dot(middle), print.v.dot(middle));
  double nearest = std::numeric_limits<double>::infinity();
  double directions = 0.0;
  for (std::size_t k = 0; k < print.hull.size(); ++k) {
    const Place a = print.hull[k] - below;
    const Place b = print.hull[(k + 1) % print.hull.size()] - below;
    const Place edge = b - a;
    if (edge.norm() > 0.0) nearest = std::min(nearest, (a.x() * b.y() - a.y() * b.x()) / edge.norm());
    directions += solid_angle(a, b, over);
  }
  stand.tip_deg = std::max(0.0, std::atan2(nearest, over) * 180.0 / std::numbers::pi);
  stand.resting = std::max(0.0, directions / (4.0 * std::numbers::pi));
  std::vector<std::array<int, 2>> cells;
  for (const Place& p : print.places)
    cells.push_back({static_cast<int>(std::floor(p.x() / kFootCell)), static_cast<int>(std::floor(p.y() / kFootCell))});
  std::sort(cells.begin(), cells.end());
  const auto count = std::distance(cells.begin(), std::unique(cells.begin(), cells.end()));
  stand.filled = std::min(1.0, static_cast<double>(count) * kFootCell * kFootCell / std::max(1.0, 0.5 * print.area));
  return stand;
}

bool is_round_on_a_rim(const EvenPoints& object, const Eigen::Vector3d& up) {
  constexpr double kRim = 0.5;          // of the outline, at least
  constexpr double kMostFilled = 0.5;   // of the rim's hull: else it is a base
  constexpr std::size_t kSectors = 36;  // around the middle of the rim
  constexpr double kClosed = 0.95;      // of them have points
  constexpr std::size_t kBands = 24;    // of height
  constexpr double kOff = 0.15;         // of the distance from the axis: walls are as thick
  constexpr double kRound = 0.9;        // share of the points that are no farther off than that
  const Stand stand = stand_of(object, up);
  if (stand.foot < kRim || stand.filled > kMostFilled) return false;
  const Footprint print(object, up);
  Place middle = Place::Zero();
  for (const Place& p : print.hull) middle += p / static_cast<double>(print.hull.size());
  std::array<bool, kSectors> around{};
  for (const Place& p : print.places) {
    const double turn = std::atan2(p.y() - middle.y(), p.x() - middle.x()) / (2.0 * std::numbers::pi) + 0.5;
    around[static_cast<std::size_t>(turn * kSectors) % kSectors] = true;
  }
  const auto closed = static_cast<double>(std::count(around.begin(), around.end(), true));
  if (closed < kClosed * kSectors) return false;
  const std::vector<double> heights = heights_of(object, up);
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  std::array<std::vector<double>, kBands> off;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double share = (heights[i] - *low) / std::max(*high - *low, 1e-9);
    const Place place(print.u.dot(object.points[i]), print.v.dot(object.points[i]));
    off[std::min(kBands - 1, static_cast<std::size_t>(share * kBands))].push_back((place - middle).norm());
  }
  std::size_t count = 0, round = 0;
  for (std::size_t band = 0; band + 1 < kBands; ++band) {  // the last one is a bottom
    if (off[band].empty()) continue;
    const double radius = median(off[band]);
    count += off[band].size();
    round += static_cast<std::size_t>(std::count_if(off[band].begin(), off[band].end(), [&](double distance) {
      return std::abs(distance - radius) <= kOff * radius;
    }));
  }
  return static_cast<double>(round) >= kRound * static_cast<double>(count);
}

std::size_t legs_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  constexpr double kLow = 0.08, kHigh = 0.2;  // of the height
  constexpr double kLeast = 0.08;             // of the points there
  const std::vector<double> heights = heights_of(object, up);
  std::vector<double> ranked = heights;
  const double ground = quantile(ranked, kRagged);
  const double height = quantile(ranked, 1.0 - kRagged) - ground;
  const Eigen::Vector3d u = up.unitOrthogonal();
  const Eigen::Vector3d v = up.cross(u);
  std::map<std::array<int, 2>, std::size_t> cells;  // with the number of their points
  std::size_t count = 0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (heights[i] < ground + kLow * height || heights[i] > ground + kHigh * height) continue;
    const Eigen::Vector3d& p = object.points[i];
    ++cells[{static_cast<int>(std::floor(u.dot(p) / kFootCell)), static_cast<int>(std::floor(v.dot(p) / kFootCell))}];
    ++count;
  }
  std::size_t legs = 0;
  while (!cells.empty()) {
    std::vector<std::array<int, 2>> open = {cells.begin()->first};
    std::size_t points = cells.begin()->second;
    cells.erase(cells.begin());
    while (!open.empty()) {
      const std::array<int, 2> from = open.back();
      open.pop_back();
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) {
          const auto next = cells.find({from[0] + dx, from[1] + dy});
          if (next == cells.end()) continue;
          points += next->second;
          open.push_back(next->first);
          cells.erase(next);
        }
      }
    }
    if (static_cast<double>(points) > kLeast * static_cast<double>(count)) ++legs;
  }
  return legs;
}

Eigen::Vector3d levelled(const EvenPoints& object, Eigen::Vector3d up) {
  for (const double share : {0.08, 0.05, 0.03}) {
    const std::vector<std::size_t> lowest = lowest_of(object, up, share);
    if (lowest.size() < 3) break;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const std::size_t i : lowest) centre += object.points[i];
    centre /= static_cast<double>(lowest.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const std::size_t i : lowest)
      covariance += (object.points[i] - centre) * (object.points[i] - centre).transpose();
    const Eigen::Vector3d normal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0).normalized();
    const double along = normal.dot(up);
    if (std::abs(along) < 0.7) break;  // what is lowest is no base
    up = along < 0.0 ? Eigen::Vector3d(-normal) : normal;
  }
  return up;
}

}  // namespace sparsha::pipeline
