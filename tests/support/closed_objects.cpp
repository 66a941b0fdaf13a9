// Analytic closed objects: a skeleton at a constant distance below the surface. Points come from patches p(u, v) by
// rejection on the area element, heights from the distance function alone.
#include "tests/support/closed_objects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <Eigen/Geometry>

namespace sparsha::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

/// (u, v) in the unit square to a place on the surface.
using PatchFunction = std::function<Vector3d(double, double)>;
/// Signed distance to the surface, negative inside.
using DistanceFunction = std::function<double(const Vector3d&)>;

struct Patch {
  PatchFunction place;
  double area_m2 = 0.0;
  double largest = 0.0;  ///< area element
  double outward = 1.0;  ///< sign of the cross product that points out of the object
};

/// The surface about `place` = patch(u, v): the cross product of its two directions, as long as the area element.
Vector3d area_vector(const PatchFunction& patch, const Vector3d& place, double u, double v) {
  constexpr double kStep = 1e-7;
  return (patch(u + kStep, v) - place).cross(patch(u, v + kStep) - place) / (kStep * kStep);
}

Vector3d gradient(const DistanceFunction& distance, const Vector3d& place) {
  constexpr double kStep = 1e-5;
  Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = kStep * Vector3d::Unit(axis);
    result[axis] = distance(place + step) - distance(place - step);
  }
  return result;
}

Patch measured(PatchFunction place, const DistanceFunction& distance) {
  constexpr int kSteps = 200;
  Patch patch{std::move(place)};
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double u = (i + 0.5) / kSteps, v = (j + 0.5) / kSteps;
      const double element = area_vector(patch.place, patch.place(u, v), u, v).norm();
      patch.area_m2 += element / (kSteps * kSteps);
      patch.largest = std::max(patch.largest, element);
    }
  }
  patch.largest *= 1.02;  // between the nodes of this search
  const Vector3d middle = patch.place(0.5, 0.5);
  patch.outward = area_vector(patch.place, middle, 0.5, 0.5).dot(gradient(distance, middle)) > 0.0 ? 1.0 : -1.0;
  return patch;
}

class AnalyticObject : public ClosedObject {
 public:
  AnalyticObject(std::vector<PatchFunction> patches, DistanceFunction distance, double radius_m,
                 const Eigen::Matrix3d& view)
      : distance_(std::move(distance)), radius_m_(radius_m), view_(view) {
    for (PatchFunction& place : patches) patches_.push_back(measured(std::move(place), distance_));
    for (const Patch& patch : patches_) area_m2_ += patch.area_m2;
    find_bounds();
  }

  double area_m2() const override { return area_m2_; }
  std::array<double, 4> bounds_m() const override { return bounds_m_; }

  SurfacePoint sample(std::mt19937_64& random) const override {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double chosen = unit(random) * area_m2_;
    std::size_t k = 0;
    while (k + 1 < patches_.size() && chosen > patches_[k].area_m2) chosen -= patches_[k++].area_m2;
    for (;;) {
      const double u = unit(random);
      const double v = unit(random);
      const Vector3d place = patches_[k].place(u, v);
      const Vector3d area = area_vector(patches_[k].place, place, u, v);
      if (unit(random) * patches_[k].largest > area.norm()) continue;
      return {view_ * place, view_ * (patches_[k].outward * area.normalized())};
    }
  }

  std::optional<double> front_m(double x, double y) const override {
    const double tolerance = 1e-7 * radius_m_;
    const Vector3d down = view_.transpose() * Vector3d(0.0, 0.0, -1.0);
    const Vector3d from = view_.transpose() * Vector3d(x, y, radius_m_);
    double t = 0.0;
    while (t < 2.0 * radius_m_) {
      const double d = distance_(from + t * down);
      if (d < tolerance) return radius_m_ - t;
      t += d;
    }
    return std::nullopt;
  }

  double distance_m(const Vector3d& place_m) const override { return distance_(view_.transpose() * place_m); }

 private:
  void find_bounds() {
    bounds_m_ = {1e300, 1e300, -1e300, -1e300};
    constexpr int kSteps = 150;
    for (const Patch& patch : patches_) {
      for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; j <= kSteps; ++j) {
          const Vector3d p = view_ * patch.place(double(i) / kSteps, double(j) / kSteps);
          bounds_m_ = {std::min(bounds_m_[0], p.x()), std::min(bounds_m_[1], p.y()), std::max(bounds_m_[2], p.x()),
                       std::max(bounds_m_[3], p.y())};
        }
      }
    }
  }

  std::vector<Patch> patches_;
  DistanceFunction distance_;
  double radius_m_;  ///< of a ball about zero that holds the object
  Eigen::Matrix3d view_;
  double area_m2_ = 0.0;
  std::array<double, 4> bounds_m_{};
};

PatchFunction sphere_patch(const Vector3d& centre, double radius) {
  return [=](double u, double v) -> Vector3d {
    const double a = 2.0 * kPi * u, b = kPi * v;
    return centre + radius * Vector3d(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
  };
}

/// The profile of the vase in (distance from the axis, height): arcs and lines that continue each other's direction.
class Profile {
 public:
  struct Piece {
    double length, curvature;  ///< curvature > 0 turns left
    Vector2d start = Vector2d::Zero();
    double heading = 0.0;
  };
  Profile(const Vector2d& start, std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
    Vector2d at = start;
    double heading = 0.0;
    for (Piece& piece : pieces_) {
      piece.start = at;
      piece.heading = heading;
      at = place(piece, piece.length);
      heading += piece.length * piece.curvature;
      length_ += piece.length;
    }
  }
  double length() const { return length_; }
  std::size_t pieces() const { return pieces_.size(); }
  /// A place a distance `offset` to the right of piece `k`, at a share of its length; beyond its ends too.
  Vector2d beside(std::size_t k, double share, double offset) const {
    const Piece& piece = pieces_[k];
    const double heading = piece.heading + share * piece.length * piece.curvature;
    return place(piece, share * piece.length) + offset * Vector2d(std::sin(heading), -std::cos(heading));
  }
  double end_heading() const { return pieces_.back().heading + pieces_.back().length * pieces_.back().curvature; }
  Vector2d end() const { return place(pieces_.back(), pieces_.back().length); }

  double distance(const Vector2d& p) const {
    double best = 1e300;
    for (const Piece& piece : pieces_) best = std::min(best, (p - nearest(piece, p)).norm());
    return best;
  }

 private:
  static Vector2d centre(const Piece& piece) {
    return piece.start + Vector2d(-std::sin(piece.heading), std::cos(piece.heading)) / piece.curvature;
  }
  static Vector2d place(const Piece& piece, double s) {
    if (piece.curvature == 0.0) return piece.start + s * Vector2d(std::cos(piece.heading), std::sin(piece.heading));
    const double heading = piece.heading + s * piece.curvature;
    return centre(piece) + Vector2d(std::sin(heading), -std::cos(heading)) / piece.curvature;
  }
  static Vector2d nearest(const Piece& piece, const Vector2d& p) {
    double s = 0.0;
    if (piece.curvature == 0.0) {
      s = (p - piece.start).dot(Vector2d(std::cos(piece.heading), std::sin(piece.heading)));
    } else {
      const Vector2d out = (p - centre(piece)) * piece.curvature;
      double turn = std::atan2(out.x(), -out.y()) - piece.heading;
      // The heading nearest to the middle of the arc.
      const double middle = 0.5 * piece.length * piece.curvature;
      turn -= 2.0 * kPi * std::round((turn - middle) / (2.0 * kPi));
      s = turn / piece.curvature;
    }
    return place(piece, std::clamp(s, 0.0, piece.length));
  }

  std::vector<Piece> pieces_;
  double length_ = 0.0;
};

constexpr double kVaseWall = 0.06;

Vector3d revolved(const Vector2d& profile, double share) {
  const double a = 2.0 * kPi * share;
  return {profile.x() * std::cos(a), profile.y(), profile.x() * std::sin(a)};
}

// The trefoil and its first two derivatives.
constexpr double kKnot = 0.32, kKnotDepth = 1.6;
std::array<Vector3d, 3> knot_at(double t) {
  const double c2 = std::cos(2.0 * t), s2 = std::sin(2.0 * t), c3 = std::cos(3.0 * t), s3 = std::sin(3.0 * t);
  const double r = 2.0 + c3;
  return {Vector3d(r * c2, r * s2, kKnotDepth * s3) * kKnot,
          Vector3d(-3.0 * s3 * c2 - 2.0 * r * s2, -3.0 * s3 * s2 + 2.0 * r * c2, 3.0 * kKnotDepth * c3) * kKnot,
          Vector3d(-9.0 * c3 * c2 + 12.0 * s3 * s2 - 4.0 * r * c2, -9.0 * c3 * s2 - 12.0 * s3 * c2 - 4.0 * r * s2,
                   -9.0 * kKnotDepth * s3) *
              kKnot};
}

/// Exact near the curve; farther than `exact_m` from it no more than the distance.
double knot_distance(const Vector3d& p, double exact_m) {
  constexpr int kCoarse = 120;
  constexpr double kBetween = 0.07;  // more than half the distance of two coarse places
  static const std::vector<Vector3d> coarse = [] {
    std::vector<Vector3d> places;
    for (int k = 0; k < kCoarse; ++k) places.push_back(knot_at(2.0 * kPi * k / kCoarse)[0]);
    return places;
  }();
  int best = 0;
  double least = 1e300;
  for (int k = 0; k < kCoarse; ++k) {
    const double d = (p - coarse[static_cast<std::size_t>(k)]).squaredNorm();
    if (d < least) {
      least = d;
      best = k;
    }
  }
  if (std::sqrt(least) - kBetween > exact_m) return std::sqrt(least) - kBetween;
  // Newton on the parameter of the nearest place.
  double t = 2.0 * kPi * best / kCoarse;
  for (int k = 0; k < 4; ++k) {
    const auto [place, slope, bend] = knot_at(t);
    const double descent = (p - place).dot(slope);
    const double curvature = slope.squaredNorm() - (p - place).dot(bend);
    t += descent / std::max(curvature, 0.3 * slope.squaredNorm());
  }
  return std::min(std::sqrt(least), (p - knot_at(t)[0]).norm());
}

}  // namespace

Eigen::Matrix3d turned(double about_x_deg, double about_y_deg) {
  const auto turn = [](double degrees, const Vector3d& axis) {
    return Eigen::AngleAxisd(degrees * kPi / 180.0, axis).toRotationMatrix();
  };
  return turn(about_x_deg, Vector3d::UnitX()) * turn(about_y_deg, Vector3d::UnitY());
}

ObjectPtr make_torus(const Eigen::Matrix3d& view) {
  static constexpr double kRing = 1.0, kTube = 0.4;
  const PatchFunction patch = [](double u, double v) -> Vector3d {
    const double a = 2.0 * kPi * u, b = 2.0 * kPi * v, r = kRing + kTube * std::cos(b);
    return {r * std::cos(a), r * std::sin(a), kTube * std::sin(b)};
  };
  const DistanceFunction distance = [](const Vector3d& p) {
    return std::hypot(std::hypot(p.x(), p.y()) - kRing, p.z()) - kTube;
  };
  return std::make_shared<AnalyticObject>(std::vector<PatchFunction>{patch}, distance, 1.5, view);
}

ObjectPtr make_two_spheres(const Eigen::Matrix3d& view) {
  const Vector3d behind(0.0, 0.0, -0.6), before(0.35, 0.2, 1.1);
  const DistanceFunction distance = [=](const Vector3d& p) {
    return std::min((p - behind).norm() - 1.0, (p - before).norm() - 0.5);
  };
  return std::make_shared<AnalyticObject>(
      std::vector<PatchFunction>{sphere_patch(behind, 1.0), sphere_patch(before, 0.5)}, distance, 1.8, view);
}

ObjectPtr make_vase(const Eigen::Matrix3d& view) {
  const auto degrees = [](double angle) { return angle * kPi / 180.0; };
  // Foot, edge of the foot, belly and shoulder, neck, all seen from the axis outwards and up.
  const Profile profile({0.0, -0.85}, {{0.25, 0.0},
                                       {0.12 * degrees(62.0), 1.0 / 0.12},
                                       {0.80 * degrees(70.0), 1.0 / 0.80},
                                       {0.30 * degrees(75.0), -1.0 / 0.30}});
  std::vector<PatchFunction> patches;
  for (std::size_t k = 0; k < profile.pieces(); ++k) {
    for (const double side : {-0.5, 0.5}) {
      patches.emplace_back([=](double u, double v) { return revolved(profile.beside(k, v, side * kVaseWall), u); });
    }
  }
  // The rim: half a circle about the profile's end.
  patches.emplace_back([=](double u, double v) {
    const double angle = profile.end_heading() + kPi * (v - 0.5);
    return revolved(profile.end() + 0.5 * kVaseWall * Vector2d(std::cos(angle), std::sin(angle)), u);
  });
  const DistanceFunction distance = [=](const Vector3d& p) {
    return profile.distance({std::hypot(p.x(), p.z()), p.y()}) - 0.5 * kVaseWall;
  };
  return std::make_shared<AnalyticObject>(std::move(patches), distance, 1.6, view);
}

ObjectPtr make_knot(const Eigen::Matrix3d& view) {
  static constexpr double kTube = 0.22;
  const PatchFunction patch = [](double u, double v) -> Vector3d {
    const double t = 2.0 * kPi * u, a = 2.0 * kPi * v;
    const auto [place, slope, bend] = knot_at(t);
    const Vector3d along = slope.normalized();
    const Vector3d across = along.cross(Vector3d::UnitZ()).normalized();
    return place + kTube * (std::cos(a) * across + std::sin(a) * along.cross(across));
  };
  const DistanceFunction distance = [](const Vector3d& p) { return knot_distance(p, kTube + 0.02) - kTube; };
  return std::make_shared<AnalyticObject>(std::vector<PatchFunction>{patch}, distance, 1.6, view);
}

ObjectPtr make_coin(const Eigen::Matrix3d& view) {
  static constexpr double kHalf = 0.04;
  std::vector<PatchFunction> patches;
  for (const double side : {-1.0, 1.0}) {
    patches.emplace_back([=](double u, double v) -> Vector3d {
      const double a = side * 2.0 * kPi * u;
      return {v * std::cos(a), v * std::sin(a), side * kHalf};
    });
  }
  patches.emplace_back([](double u, double v) -> Vector3d {
    const double a = 2.0 * kPi * u, b = kPi * (v - 0.5), r = 1.0 + kHalf * std::cos(b);
    return {r * std::cos(a), r * std::sin(a), kHalf * std::sin(b)};
  });
  const DistanceFunction distance = [](const Vector3d& p) {
    return std::hypot(std::max(0.0, std::hypot(p.x(), p.y()) - 1.0), p.z()) - kHalf;
  };
  return std::make_shared<AnalyticObject>(std::move(patches), distance, 1.1, view);
}

ObjectPtr make_box(const Eigen::Vector3d& half_m, const Eigen::Matrix3d& view) {
  std::vector<PatchFunction> patches;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      patches.emplace_back([=](double u, double v) -> Vector3d {
        Vector3d p;
        p[axis] = side * half_m[axis];
        p[(axis + 1) % 3] = half_m[(axis + 1) % 3] * (2.0 * u - 1.0);
        p[(axis + 2) % 3] = half_m[(axis + 2) % 3] * (2.0 * v - 1.0);
        return p;
      });
    }
  }
  const DistanceFunction distance = [=](const Vector3d& p) {
    const Vector3d beyond = p.cwiseAbs() - half_m;
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
  };
  return std::make_shared<AnalyticObject>(std::move(patches), distance, half_m.norm(), view);
}

ObjectPtr make_bevelled_cube(double half_m, double bevel_m, const Eigen::Matrix3d& view) {
  // Where two coordinates are this together, the bevel lies.
  const double sum_m = 2.0 * half_m - bevel_m;
  const double face_m = sum_m - half_m;
  std::vector<PatchFunction> patches;
  for (int axis = 0; axis < 3; ++axis) {
    const int second = (axis + 1) % 3, third = (axis + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      patches.emplace_back([=](double u, double v) -> Vector3d {
        Vector3d p;
        p[axis] = side * half_m;
        p[second] = face_m * (2.0 * u - 1.0);
        p[third] = face_m * (2.0 * v - 1.0);
        return p;
      });
      for (const double other : {-1.0, 1.0}) {
        patches.emplace_back([=](double u, double v) -> Vector3d {
          const double x = face_m + u * bevel_m, y = sum_m - x;
          Vector3d p;
          p[axis] = side * x;
          p[second] = other * y;
          p[third] = (sum_m - std::max(x, y)) * (2.0 * v - 1.0);
          return p;
        });
      }
    }
  }
  const DistanceFunction distance = [=](const Vector3d& p) {
    const Vector3d a = p.cwiseAbs();
    const double face = a.maxCoeff() - half_m;
    return std::max(face, (a.sum() - a.minCoeff() - sum_m) / std::sqrt(2.0));
  };
  return std::make_shared<AnalyticObject>(std::move(patches), distance, std::sqrt(3.0) * half_m, view);
}

std::vector<NamedObject> analytic_objects() {
  return {{"torus", make_torus()},
          {"two spheres", make_two_spheres()},
          {"vase from the side", make_vase(turned(4.0, 0.0))},
          {"vase from above", make_vase(turned(48.0, 0.0))},
          {"knot", make_knot()},
          {"coin", make_coin()}};
}

}  // namespace sparsha::test
