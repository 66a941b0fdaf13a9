#include "pipeline/suggest/straight_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr double kOutside = 0.002;    // share of points beyond each edge: strays
constexpr double kSmaller = 0.97;     // of the upright rectangle's area: an edge leans by more than a degree
constexpr double kFilled = 0.9;       // share of the rectangle's cells that hold points
constexpr double kPointsOfCell = 10;  // on average
constexpr std::size_t kFewest = 1000;
constexpr std::size_t kFirst = 20'000;  // points that tell the angle to a degree
constexpr double kDegree = std::numbers::pi / 180.0;

using Flat = std::vector<Eigen::Vector2d>;

struct Rectangle {
  double turn = 0.0;  ///< of its edges, radians
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();

  [[nodiscard]] double area() const { return (high - low).prod(); }
};

// The rectangle with that turn that holds nearly all points.
Rectangle rectangle_at(const Flat& points, double turn, std::vector<double>& values) {
  Rectangle found;
  found.turn = turn;
  const Eigen::Vector2d across(std::cos(turn), std::sin(turn)), along(-std::sin(turn), std::cos(turn));
  const auto few = static_cast<std::ptrdiff_t>(kOutside * static_cast<double>(points.size()));
  for (const Eigen::Index axis : {0, 1}) {
    values.clear();
    for (const Eigen::Vector2d& p : points) values.push_back(p.dot(axis == 0 ? across : along));
    std::nth_element(values.begin(), values.begin() + few, values.end());
    found.low[axis] = values[static_cast<std::size_t>(few)];
    std::nth_element(values.begin(), values.end() - 1 - few, values.end());
    found.high[axis] = *(values.end() - 1 - few);
  }
  return found;
}

Rectangle smallest(const Flat& points, double from, double to, double step) {
  std::vector<double> values;
  Rectangle best = rectangle_at(points, from, values);
  for (int k = 1; from + k * step <= to; ++k) {
    const Rectangle other = rectangle_at(points, from + k * step, values);
    if (other.area() < best.area()) best = other;
  }
  return best;
}

// Share of the rectangle that has points in it.
double filled(const Flat& points, const Rectangle& rectangle) {
  const Eigen::Vector2d size = rectangle.high - rectangle.low;
  const double cell = std::sqrt(size.prod() * kPointsOfCell / static_cast<double>(points.size()));
  const auto nx = static_cast<std::size_t>(size.x() / cell), ny = static_cast<std::size_t>(size.y() / cell);
  if (nx < 4 || ny < 4) return 0.0;
  std::vector<std::uint8_t> cells(nx * ny, 0);
  const Eigen::Rotation2Dd back(-rectangle.turn);
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d at = (back * p - rectangle.low).cwiseQuotient(size);
    if (!(at.minCoeff() >= 0.0 && at.maxCoeff() < 1.0)) continue;
    cells[static_cast<std::size_t>(at.y() * static_cast<double>(ny)) * nx +
          static_cast<std::size_t>(at.x() * static_cast<double>(nx))] = 1;
  }
  return static_cast<double>(std::count(cells.begin(), cells.end(), 1)) / static_cast<double>(cells.size());
}

}  // namespace

std::optional<Eigen::Vector3d> up_along_edges(const std::vector<Eigen::Vector3d>& points_m,
                                              const Eigen::Vector3d& look_from, const Eigen::Vector3d& up) {
  if (points_m.size() < kFewest) return {};
  const Eigen::Vector3d z = look_from.normalized();
  const Eigen::Vector3d y = (up - up.dot(z) * z).normalized();
  const Eigen::Vector3d x = y.cross(z);
  if (!(y.norm() > 0.5)) return {};  // up along the view
  Flat all, some;
  const std::size_t stride = std::max<std::size_t>(1, points_m.size() / kFirst);
  for (std::size_t k = 0; k < points_m.size(); ++k) {
    const Eigen::Vector3d p = points_m[k] - points_m.front();
    all.emplace_back(p.dot(x), p.dot(y));
    if (k % stride == 0) some.push_back(all.back());
  }
  std::vector<double> values;
  const double upright = rectangle_at(all, 0.0, values).area();
  const Rectangle near = smallest(some, -45.0 * kDegree, 44.5 * kDegree, kDegree);
  const Rectangle best = smallest(all, near.turn - kDegree, near.turn + kDegree, 0.05 * kDegree);
  if (!(best.area() > 0.0 && best.area() < kSmaller * upright) || filled(all, best) < kFilled) return {};
  return (std::cos(best.turn) * y - std::sin(best.turn) * x).normalized();
}

}  // namespace sparsha::pipeline
