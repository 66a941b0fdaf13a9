// Rotations of the affine transform from the scan frame to the grid frame.
#include "viewer/cloud/orientation.h"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "scene/config/orientation.h"
#include "scene/frame/euler.h"

namespace sparsha::viewer {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Matrix4d affine(const Eigen::Matrix3d& linear) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = linear;
  return m;
}

Eigen::Matrix4d about(double angle, const Eigen::Vector3d& axis) {
  return affine(Eigen::AngleAxisd(angle, axis).toRotationMatrix());
}

Eigen::Matrix3d rotation_of(const Eigen::Matrix4d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Eigen::Matrix3d(m.topLeftCorner<3, 3>()),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

}  // namespace

Eigen::Vector3d UpAxis::front() const {
  return axis_ == 2 ? Eigen::Vector3d(-Eigen::Vector3d::UnitY()) : Eigen::Vector3d::UnitZ();
}

const char* UpAxis::name() const {
  constexpr std::array<const char*, 6> kNames{"x", "-x", "y", "-y", "z", "-z"};
  return kNames[static_cast<std::size_t>(2 * axis_ + (down_ ? 1 : 0))];
}

std::span<const UpAxis> all_up_axes() {
  static const std::array<UpAxis, 6> kAxes{UpAxis(1, false), UpAxis(2, false), UpAxis(0, false),
                                           UpAxis(1, true),  UpAxis(2, true),  UpAxis(0, true)};
  return kAxes;
}

const char* name_of(Face face) {
  constexpr std::array<const char*, kFaces> kNames{"Front", "Back", "Left", "Right", "Top", "Bottom"};
  return kNames[static_cast<std::size_t>(face)];
}

double scale_of(const Eigen::Matrix4d& scan_to_grid) {
  return std::cbrt(std::abs(scan_to_grid.topLeftCorner<3, 3>().determinant()));
}

Eigen::Matrix4d seen_from(Face face, UpAxis axis, const Eigen::Matrix4d& present) {
  const Eigen::Vector3d up = axis.direction();
  const Eigen::Vector3d front = axis.front();
  const Eigen::Vector3d right = up.cross(front);
  const double scale = scale_of(present);
  switch (face) {
    case Face::front:
      return scene::look_from(front, up, scale);
    case Face::back:
      return scene::look_from(-front, up, scale);
    case Face::left:
      return scene::look_from(-right, up, scale);
    case Face::right:
      return scene::look_from(right, up, scale);
    case Face::top:
      return scene::look_from(up, -front, scale);
    case Face::bottom:
      break;
  }
  return scene::look_from(-up, front, scale);
}

Eigen::Matrix4d as_scanned(const Eigen::Matrix4d& present) {
  return affine(scale_of(present) * Eigen::Matrix3d::Identity());
}

Eigen::Matrix4d turned(const Eigen::Matrix4d& scan_to_grid, UpAxis up, double turn, double tilt) {
  return about(tilt, Eigen::Vector3d::UnitX()) * scan_to_grid * about(turn, up.direction());
}

Eigen::Matrix4d rolled(const Eigen::Matrix4d& scan_to_grid, double about_x, double about_y, double about_z) {
  return about(about_z, Eigen::Vector3d::UnitZ()) * about(about_y, Eigen::Vector3d::UnitY()) *
         about(about_x, Eigen::Vector3d::UnitX()) * scan_to_grid;
}

Eigen::Matrix4d upright(const Eigen::Matrix4d& scan_to_grid, UpAxis up) {
  const Eigen::Matrix3d rotation = rotation_of(scan_to_grid);
  Eigen::Vector3d axis = rotation * up.direction();
  constexpr double kAlongTheView = 0.1;
  if (axis.head<2>().norm() < kAlongTheView) {
    double best = -1.0;
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d candidate = (k < 3 ? 1.0 : -1.0) * rotation.col(k % 3);
      if (candidate.y() <= best) continue;
      best = candidate.y();
      axis = candidate;
    }
  }
  return rolled(scan_to_grid, 0.0, 0.0, std::atan2(axis.x(), axis.y()));
}

Eigen::Vector3d euler_deg(const Eigen::Matrix4d& scan_to_grid) { return scene::euler_deg(rotation_of(scan_to_grid)); }

Eigen::Matrix4d with_euler(const Eigen::Vector3d& angles_deg, const Eigen::Matrix4d& present) {
  return about(angles_deg.z() * kDegree, Eigen::Vector3d::UnitZ()) *
         about(angles_deg.y() * kDegree, Eigen::Vector3d::UnitY()) *
         about(angles_deg.x() * kDegree, Eigen::Vector3d::UnitX()) * as_scanned(present);
}

}  // namespace sparsha::viewer
