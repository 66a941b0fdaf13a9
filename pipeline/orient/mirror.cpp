// Points mirrored into a field of distances from the surface.
#include "pipeline/orient/mirror.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr double kCell = 2.0;         // pixels: width of the cells of the field of distances
constexpr double kFar = 8.0;          // pixels from the surface, from which a mirrored point counts for nothing
constexpr std::size_t kTried = 2500;  // points that are mirrored
constexpr int kDirections = 400;      // over half of the sphere: 6 degrees apart
constexpr double kApart = 0.906;      // cosine of 25 degrees, between planes that are not the same

// Distances from the surface, cell by cell.
class Field {
 public:
  explicit Field(const EvenPoints& object) : half_(object.half + kFar) {
    width_ = static_cast<int>(2.0 * half_ / kCell) + 2;
    const auto count =
        static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_);
    distance_.assign(count, static_cast<float>(kFar));
    for (const Eigen::Vector3d& p : object.points) distance_[cell_of(p)] = 0.0F;
    sweep(1);
    sweep(-1);
  }
  [[nodiscard]] double from(const Eigen::Vector3d& p) const {
    return (p.array().abs() < half_).all() ? static_cast<double>(distance_[cell_of(p)]) : kFar;
  }

 private:
  [[nodiscard]] std::size_t cell_of(const Eigen::Vector3d& p) const {
    const auto at = [&](double along) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>((along + half_) / kCell), 0, width_ - 1));
    };
    const auto width = static_cast<std::size_t>(width_);
    return (at(p.z()) * width + at(p.y())) * width + at(p.x());
  }
  // Chamfer distances: from the cells before each, in one order and then in the other.
  void sweep(int way) {
    struct Before {
      int x, y, z;
      float apart;
    };
    std::vector<Before> before;
    for (int z = -1; z <= 0; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (z < 0 || y < 0 || (y == 0 && x < 0))
            before.push_back({way * x, way * y, way * z, static_cast<float>(kCell * std::sqrt(x * x + y * y + z * z))});
    const int first = way > 0 ? 0 : width_ - 1;
    const auto inside = [&](int k) { return k >= 0 && k < width_; };
    const auto index = [&](int x, int y, int z) {
      return static_cast<std::size_t>((static_cast<std::ptrdiff_t>(z) * width_ + y) * width_ + x);
    };
    for (int z = first; inside(z); z += way) {
      for (int y = first; inside(y); y += way) {
        for (int x = first; inside(x); x += way) {
          float& here = distance_[index(x, y, z)];
          for (const Before& b : before) {
            if (!inside(x + b.x) || !inside(y + b.y) || !inside(z + b.z)) continue;
            here = std::min(here, distance_[index(x + b.x, y + b.y, z + b.z)] + b.apart);
          }
        }
      }
    }
  }

  double half_;
  int width_ = 0;
  std::vector<float> distance_;
};

Eigen::Vector3d centre_of(const EvenPoints& object) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : object.points) sum += p;
  return sum / static_cast<double>(std::max<std::size_t>(1, object.points.size()));
}

class Mirror {
 public:
  explicit Mirror(const EvenPoints& object) : field_(object), centre_(centre_of(object)) {
    const std::size_t step = std::max<std::size_t>(1, object.points.size() / kTried);
    for (std::size_t i = 0; i < object.points.size(); i += step) some_.push_back(object.points[i]);
  }
  [[nodiscard]] double alike(const Eigen::Vector3d& normal, double beside) const {
    const double offset = normal.dot(centre_) + beside;
    double sum = 0.0;
    for (const Eigen::Vector3d& p : some_) sum += field_.from(p - 2.0 * (normal.dot(p) - offset) * normal);
    return 1.0 - sum / (kFar * static_cast<double>(some_.size()));
  }
  // Turns and shifts a plane by ever smaller steps while that is better.
  [[nodiscard]] MirrorPlane refined(Eigen::Vector3d normal) const {
    double beside = 0.0;
    double best = alike(normal, beside);
    double turn = 4.0 * std::numbers::pi / 180.0;
    double shift = 3.0;  // pixels
    while (turn > 0.4 * std::numbers::pi / 180.0) {
      bool better = false;
      const Eigen::Vector3d u = normal.unitOrthogonal();
      const Eigen::Vector3d v = normal.cross(u);
      const std::array<Eigen::Vector3d, 6> normals = {(normal + turn * u).normalized(),
                                                      (normal - turn * u).normalized(),
                                                      (normal + turn * v).normalized(),
                                                      (normal - turn * v).normalized(),
                                                      normal,
                                                      normal};
      for (std::size_t k = 0; k < normals.size(); ++k) {
        const double there = beside + (k == 4 ? shift : k == 5 ? -shift : 0.0);
        const double value = alike(normals[k], there);
        if (value <= best + 1e-9) continue;
        best = value;
        normal = normals[k];
        beside = there;
        better = true;
      }
      if (better) continue;
      turn *= 0.5;
      shift *= 0.5;
    }
    return {normal, normal.dot(centre_) + beside, best};
  }

 private:
  Field field_;
  Eigen::Vector3d centre_;
  std::vector<Eigen::Vector3d> some_;
};

}  // namespace

Eigen::Matrix3d principal_frame(const EvenPoints& object) {
  const Eigen::Vector3d centre = centre_of(object);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : object.points) covariance += (p - centre) * (p - centre).transpose();
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  Eigen::Matrix3d frame;
  for (const Eigen::Index k : {0, 1}) {
    frame.col(k) = axes.col(2 - k);
    double skewness = 0.0;
    for (const Eigen::Vector3d& p : object.points) skewness += std::pow(frame.col(k).dot(p - centre), 3);
    if (skewness < 0.0) frame.col(k) *= -1.0;
  }
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

std::vector<MirrorPlane> mirror_planes(const EvenPoints& object, std::size_t count) {
  std::vector<MirrorPlane> planes;
  if (object.points.size() < 4) return planes;
  const Mirror mirror(object);
  const Eigen::Matrix3d frame = principal_frame(object);
  struct Tried {
    Eigen::Vector3d normal;
    double alike;
  };
  std::vector<Tried> tried;
  for (int k = 0; k < kDirections; ++k) {
    const double z = (k + 0.5) / kDirections;
    const double around = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d normal = frame * Eigen::Vector3d(r * std::cos(around), r * std::sin(around), z);
    tried.push_back({normal, mirror.alike(normal, 0.0)});
  }
  for (const Eigen::Index k : {0, 1, 2}) tried.push_back({frame.col(k), mirror.alike(frame.col(k), 0.0)});
  std::stable_sort(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) { return a.alike > b.alike; });
  const auto same = [&](const std::vector<MirrorPlane>& all, const Eigen::Vector3d& normal) {
    return std::any_of(all.begin(), all.end(),
                       [&](const MirrorPlane& m) { return std::abs(m.normal.dot(normal)) > kApart; });
  };
  std::vector<MirrorPlane> starts;
  for (const Tried& t : tried) {
    if (starts.size() >= 3 * count) break;
    if (same(starts, t.normal)) continue;
    starts.push_back({t.normal, 0.0, t.alike});
  }
  for (MirrorPlane& start : starts) start = mirror.refined(start.normal);
  std::stable_sort(starts.begin(), starts.end(),
                   [](const MirrorPlane& a, const MirrorPlane& b) { return a.alike > b.alike; });
  for (const MirrorPlane& plane : starts)
    if (planes.size() < count && !same(planes, plane.normal)) planes.push_back(plane);
  return planes;
}

}  // namespace sparsha::pipeline
