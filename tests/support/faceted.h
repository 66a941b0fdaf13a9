// Closed objects with plane faces and their exact signed distance: prisms, boxes without a box, two boxes. Lengths are
// in metres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "tests/support/closed_objects.h"

namespace sparsha::test {

/// Points come from rectangles, of which those count that lie on the surface of a signed distance.
class Faceted : public ClosedObject {
 public:
  using Distance = std::function<double(const Eigen::Vector3d&)>;
  struct Face {
    Eigen::Vector3d corner, first, second, normal;
    [[nodiscard]] double area_m2() const { return first.norm() * second.norm(); }
  };

  Faceted(std::vector<Face> faces, Distance distance, const Eigen::Matrix3d& view)
      : faces_(std::move(faces)), distance_(std::move(distance)), view_(view) {
    for (const Face& face : faces_) faces_m2_ += face.area_m2();
    std::mt19937_64 random(99);
    std::size_t on = 0;
    for (int k = 0; k < kTried; ++k) on += is_on(any_place(random)) ? 1 : 0;
    area_m2_ = faces_m2_ * static_cast<double>(on) / kTried;
  }
  [[nodiscard]] double area_m2() const override { return area_m2_; }
  [[nodiscard]] SurfacePoint sample(std::mt19937_64& random) const override {
    SurfacePoint place = any_place(random);
    while (!is_on(place)) place = any_place(random);
    return {view_ * place.position_m, view_ * place.normal};
  }
  [[nodiscard]] std::optional<double> front_m(double /*x*/, double /*y*/) const override { return std::nullopt; }
  [[nodiscard]] std::array<double, 4> bounds_m() const override { return {-100.0, -100.0, 100.0, 100.0}; }
  [[nodiscard]] double distance_m(const Eigen::Vector3d& place_m) const override {
    return distance_(view_.transpose() * place_m);
  }
  [[nodiscard]] const Eigen::Matrix3d& view() const { return view_; }

 private:
  static constexpr int kTried = 100'000;

  [[nodiscard]] bool is_on(const SurfacePoint& place) const {
    constexpr double kBeside_m = 1e-6;
    return distance_(place.position_m + kBeside_m * place.normal) > 0.0 &&
           distance_(place.position_m - kBeside_m * place.normal) < 0.0;
  }
  [[nodiscard]] SurfacePoint any_place(std::mt19937_64& random) const {
    const auto share = [&] { return std::generate_canonical<double, 53>(random); };
    double chosen = share() * faces_m2_;
    std::size_t k = 0;
    while (k + 1 < faces_.size() && chosen > faces_[k].area_m2()) chosen -= faces_[k++].area_m2();
    const double u = share(), v = share();
    return {faces_[k].corner + u * faces_[k].first + v * faces_[k].second, faces_[k].normal};
  }

  std::vector<Face> faces_;
  Distance distance_;
  Eigen::Matrix3d view_;
  double faces_m2_ = 0.0, area_m2_ = 0.0;
};

using FacetedPtr = std::shared_ptr<const Faceted>;

/// To a simple polygon, negative inside.
inline double polygon_distance(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& place) {
  double least = 1e300;
  bool inside = false;
  for (std::size_t k = 0, j = corners.size() - 1; k < corners.size(); j = k++) {
    const Eigen::Vector2d edge = corners[k] - corners[j], from = place - corners[j];
    const double share = std::clamp(from.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (from - share * edge).squaredNorm());
    if ((corners[k].y() > place.y()) == (corners[j].y() > place.y())) continue;
    const double crosses_x = corners[k].x() - edge.x() * (corners[k].y() - place.y()) / edge.y();
    inside = inside != (place.x() < crosses_x);
  }
  return inside ? -std::sqrt(least) : std::sqrt(least);
}

/// `corners`: (x, z), counterclockwise as seen from -y; over |y| <= `half_m`.
inline FacetedPtr make_prism(const std::vector<Eigen::Vector2d>& corners, double half_m, const Eigen::Matrix3d& view) {
  std::vector<Faceted::Face> faces;
  Eigen::Vector2d low = corners.front(), high = corners.front();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d& from = corners[k];
    const Eigen::Vector2d edge = corners[(k + 1) % corners.size()] - from;
    const Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
    low = low.cwiseMin(from), high = high.cwiseMax(from);
    faces.push_back({{from.x(), -half_m, from.y()},
                     {edge.x(), 0.0, edge.y()},
                     {0.0, 2.0 * half_m, 0.0},
                     {normal.x(), 0.0, normal.y()}});
  }
  for (const double side : {-1.0, 1.0})
    faces.push_back({{low.x(), side * half_m, low.y()},
                     {high.x() - low.x(), 0.0, 0.0},
                     {0.0, 0.0, high.y() - low.y()},
                     {0.0, side, 0.0}});
  const auto distance = [corners, half_m](const Eigen::Vector3d& place) {
    const double across = polygon_distance(corners, {place.x(), place.z()}), along = std::abs(place.y()) - half_m;
    return std::hypot(std::max(across, 0.0), std::max(along, 0.0)) + std::min(0.0, std::max(across, along));
  };
  return std::make_shared<Faceted>(std::move(faces), distance, view);
}

struct Bounds {
  Eigen::Vector3d low, high;

  [[nodiscard]] double distance(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d beyond = (place - 0.5 * (low + high)).cwiseAbs() - 0.5 * (high - low);
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
  }
  /// `outwards`: -1 for the faces of what is taken away.
  void add_faces(double outwards, std::vector<Faceted::Face>& faces) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const bool upper : {false, true}) {
        Eigen::Vector3d corner = low;
        if (upper) corner[axis] = high[axis];
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        faces.push_back({corner, (high[u] - low[u]) * Eigen::Vector3d::Unit(u),
                         (high[v] - low[v]) * Eigen::Vector3d::Unit(v),
                         (upper ? outwards : -outwards) * Eigen::Vector3d::Unit(axis)});
      }
  }
};

/// A box of which another one is taken away. Outside, the distance is at most the true one.
inline FacetedPtr make_notched(const Bounds& box, const Bounds& taken, const Eigen::Matrix3d& view) {
  std::vector<Faceted::Face> faces;
  box.add_faces(1.0, faces);
  taken.add_faces(-1.0, faces);
  return std::make_shared<Faceted>(
      std::move(faces),
      [=](const Eigen::Vector3d& place) { return std::max(box.distance(place), -taken.distance(place)); }, view);
}

/// Two boxes that overlap. Inside, where they do, the depth is at most the true one.
inline FacetedPtr make_two_boxes(const Bounds& one, const Bounds& other, const Eigen::Matrix3d& view) {
  std::vector<Faceted::Face> faces;
  one.add_faces(1.0, faces);
  other.add_faces(1.0, faces);
  return std::make_shared<Faceted>(
      std::move(faces),
      [=](const Eigen::Vector3d& place) { return std::min(one.distance(place), other.distance(place)); }, view);
}

}  // namespace sparsha::test
