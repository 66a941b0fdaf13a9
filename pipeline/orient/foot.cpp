// Convex hulls of what lies lowest and of all.
#include "pipeline/orient/foot.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "base/numbers/statistics.h"

namespace sparsha::pipeline {
namespace {

constexpr double kFootHeight = 0.03;    // of the object's height
constexpr double kRagged = 0.002;       // of the points, beyond its lowest and highest place
constexpr std::size_t kOutline = 4000;  // points that an outline is taken from

using Place = Eigen::Vector2d;

// Twice the area of the convex hull.
double hull_area(std::vector<Place> places) {
  if (places.size() < 3) return 0.0;
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

double foot_of(const EvenPoints& object, const Eigen::Vector3d& up) {
  const Eigen::Vector3d u = up.unitOrthogonal();
  const Eigen::Vector3d v = up.cross(u);
  const auto place = [&](const Eigen::Vector3d& p) { return Place(u.dot(p), v.dot(p)); };
  std::vector<Place> all;
  const std::size_t step = std::max<std::size_t>(1, object.points.size() / kOutline);
  for (std::size_t i = 0; i < object.points.size(); i += step) all.push_back(place(object.points[i]));
  std::vector<Place> foot;
  for (const std::size_t i : lowest_of(object, up, kFootHeight)) foot.push_back(place(object.points[i]));
  const double outline = hull_area(std::move(all));
  return outline > 0.0 ? hull_area(std::move(foot)) / outline : 0.0;
}

}  // namespace sparsha::pipeline
