// Computes the view and projection matrices of cameras.
#include "viewer/camera/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "scene/scene.h"

namespace sparsha::viewer {

Stage stage_of(const scene::SceneDescription& description) {
  const scene::Lattice& lattice = description.levels.front();
  const double width_m = (lattice.nx - 1) * lattice.spacing_m;
  const double height_m = (lattice.ny - 1) * lattice.spacing_m;
  Stage stage;
  stage.unit_m = std::max({width_m, height_m, lattice.spacing_m, 1e-12});
  stage.anchor_m = lattice.origin_m + Eigen::Vector3d(0.5 * width_m, 0.5 * height_m, 0.0);
  const double middle_m = 0.5 * (description.height_min_m + description.height_max_m);
  if (std::isfinite(middle_m) && description.height_max_m > description.height_min_m) stage.anchor_m.z() = middle_m;
  if (is_whole(description)) {
    const ObjectBox bounds = bounds_of(*description.charts);
    stage.anchor_m = 0.5 * (bounds.low_m + bounds.high_m);
    stage.unit_m = (bounds.high_m - bounds.low_m).maxCoeff();
  }
  return stage;
}

bool is_whole(const scene::SceneDescription& description) {
  return description.charts && !description.charts->sheets.empty();
}

// A sheet's nodes tell two of the three axes; each axis is told by the sheets of four sides.
ObjectBox bounds_of(const scene::Charts& charts) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const scene::Sheet& sheet : charts.sheets) {
    const scene::SideAxes axes = scene::SideAxes::of(sheet.side);
    low[axes.u] = std::min(low[axes.u], static_cast<double>(sheet.first_u));
    high[axes.u] = std::max(high[axes.u], static_cast<double>(sheet.first_u + sheet.nx - 1));
    low[axes.v] = std::min(low[axes.v], static_cast<double>(sheet.first_v));
    high[axes.v] = std::max(high[axes.v], static_cast<double>(sheet.first_v + sheet.ny - 1));
  }
  for (int axis = 0; axis < 3; ++axis)
    if (!(low[axis] <= high[axis])) low[axis] = high[axis] = 0.0;  // sheets of one axis only
  return {charts.origin_m + charts.spacing_m * low, charts.origin_m + charts.spacing_m * high};
}

Eigen::Matrix3d Camera::axes() const {
  const double ct = std::cos(turn_rad), st = std::sin(turn_rad);
  const double cu = std::cos(tilt_rad), su = std::sin(tilt_rad);
  Eigen::Matrix3d axes;
  if (upright) {
    axes.col(0) = Eigen::Vector3d(ct, 0.0, -st);
    axes.col(1) = Eigen::Vector3d(st * su, cu, ct * su);
    axes.col(2) = Eigen::Vector3d(st * cu, -su, ct * cu);
    return axes;
  }
  axes.col(0) = Eigen::Vector3d(ct, st, 0.0);
  axes.col(1) = Eigen::Vector3d(-st * cu, ct * cu, su);
  axes.col(2) = Eigen::Vector3d(st * su, -ct * su, cu);
  return axes;
}

View make_view(const Camera& camera, int width, int height, double eye_shift, double convergence) {
  const double screen = std::max(convergence * camera.distance, 1e-9);  // distance of zero parallax
  View view;
  view.width = std::max(width, 1);
  view.height = std::max(height, 1);
  const double aspect = static_cast<double>(view.width) / view.height;
  const Eigen::Matrix3d axes = camera.axes();
  view.focus = camera.target;
  view.eye = camera.target + axes.col(2) * camera.distance + axes.col(0) * eye_shift;

  Eigen::Matrix4d look = Eigen::Matrix4d::Identity();
  look.topLeftCorner<3, 3>() = axes.transpose();
  look.topRightCorner<3, 1>() = -axes.transpose() * view.eye;

  const double far = camera.distance + camera.reach;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  if (camera.field_rad <= 0.0) {
    const double near = camera.distance - camera.reach;
    clip(0, 0) = 1.0 / (camera.half_height * aspect);
    clip(0, 2) = -eye_shift / (screen * camera.half_height * aspect);
    clip(1, 1) = 1.0 / camera.half_height;
    clip(2, 2) = -2.0 / (far - near);
    clip(2, 3) = -(far + near) / (far - near);
    clip(3, 3) = 1.0;
  } else {
    const double near = std::max(camera.distance - camera.reach, 0.05 * camera.distance);
    const double focal = 1.0 / std::tan(0.5 * camera.field_rad);
    clip(0, 0) = focal / aspect;
    clip(1, 1) = focal;
    // Off axis: the plane of zero parallax stays where it is in the picture, whichever eye looks.
    clip(0, 2) = -eye_shift * focal / (aspect * screen);
    clip(2, 2) = -(far + near) / (far - near);
    clip(2, 3) = -2.0 * far * near / (far - near);
    clip(3, 2) = -1.0;
  }
  view.axes = axes;
  view.parallel = camera.field_rad <= 0.0;
  view.depth = {clip(2, 2), clip(2, 3)};
  view.projection = clip * look;
  view.inverse = view.projection.inverse();
  return view;
}

std::optional<Eigen::Vector2d> View::to_pixel(const Eigen::Vector3d& world) const {
  const Eigen::Vector4d clip = projection * world.homogeneous();
  if (!(clip.w() > 0.0)) return std::nullopt;
  return Eigen::Vector2d(0.5 * (clip.x() / clip.w() + 1.0) * width, 0.5 * (1.0 - clip.y() / clip.w()) * height);
}

View::Ray View::ray(double x, double y) const {
  const double cx = 2.0 * x / width - 1.0, cy = 1.0 - 2.0 * y / height;
  const Eigen::Vector4d a = inverse * Eigen::Vector4d(cx, cy, -1.0, 1.0);
  const Eigen::Vector4d b = inverse * Eigen::Vector4d(cx, cy, 1.0, 1.0);
  const Eigen::Vector3d from = a.head<3>() / a.w(), to = b.head<3>() / b.w();
  return {from, (to - from).normalized()};
}

bool looks_away(const View& view, const Stage& stage, const Eigen::Vector3d& grid_m, const Eigen::Vector3d& normal) {
  const auto pixel = view.to_pixel(stage.to_world(grid_m));
  return pixel && (stage.turn * normal).dot(view.ray(pixel->x(), pixel->y()).direction) > 0.0;
}

std::optional<Eigen::Vector3d> View::on_plane(double x, double y, double world_z) const {
  const Ray r = ray(x, y);
  if (std::abs(r.direction.z()) < 1e-9) return std::nullopt;
  const double t = (world_z - r.origin.z()) / r.direction.z();
  if (t < 0.0) return std::nullopt;
  return Eigen::Vector3d(r.origin + t * r.direction);
}

double View::pixels_per_unit(const Eigen::Vector3d& world) const {
  const double w = (projection * world.homogeneous()).w();
  const double across = projection.topLeftCorner<1, 3>().norm();
  return 0.5 * width * across / std::max(w, 1e-12);
}

bool View::misses(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const {
  std::array<int, 5> out{};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                            (corner & 4) != 0 ? high.z() : low.z());
    const Eigen::Vector4d c = projection * p.homogeneous();
    out[0] += c.x() < -c.w() ? 1 : 0;
    out[1] += c.x() > c.w() ? 1 : 0;
    out[2] += c.y() < -c.w() ? 1 : 0;
    out[3] += c.y() > c.w() ? 1 : 0;
    out[4] += c.z() < -c.w() ? 1 : 0;
  }
  return std::ranges::any_of(out, [](int count) { return count == 8; });
}

}  // namespace sparsha::viewer
