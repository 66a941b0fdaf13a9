// The truth in the grid frame.
#include <cmath>

#include "pipeline/base/error.h"
#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

Eigen::Matrix3d grid_from_scan_rotation(const SimulationConfig& config) {
  const auto length = [](const Eigen::Vector3d& v) { return std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()); };
  const double look = length(config.look_from);
  const double up = length(config.up);
  if (!(look > 0.0) || !(up > 0.0))
    throw usage_error("a direction of the placement is zero", "expected a vector with a length");
  const Eigen::Vector3d z = config.look_from / look;
  const Eigen::Vector3d across = (config.up / up).cross(z);
  if (!(length(across) > 1e-6)) throw usage_error("placement: up is parallel to look_from", "expected two directions");
  const Eigen::Vector3d x = across / length(across);
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rotation;
}

Truth::Truth(const SimulationConfig& config) : surface_(config.surface), scan_to_grid_(Eigen::Matrix4d::Identity()) {
  const Eigen::Matrix3d rotation = grid_from_scan_rotation(config);
  scan_to_grid_.topLeftCorner<3, 3>() = rotation;
  grid_origin_m_ = rotation * config.origin_m;
  const double width = surface_.width_m();
  const double height = surface_.height_m();
  lattice_.spacing_m = std::fmax(width, height) / (config.nodes - 1);
  lattice_.nx = static_cast<int>(std::floor(width / lattice_.spacing_m + 1e-9)) + 1;
  lattice_.ny = static_cast<int>(std::floor(height / lattice_.spacing_m + 1e-9)) + 1;
  lattice_.origin_m = grid_origin_m_;
}

std::array<double, 4> Truth::bounds_m() const {
  return {grid_origin_m_.x(), grid_origin_m_.y(), grid_origin_m_.x() + surface_.width_m(),
          grid_origin_m_.y() + surface_.height_m()};
}

double Truth::height_m(double x, double y) const {
  return surface_.z(x - grid_origin_m_.x(), y - grid_origin_m_.y()) + grid_origin_m_.z();
}
double Truth::step_distance_m(double x, double y) const {
  return surface_.step_distance_m(x - grid_origin_m_.x(), y - grid_origin_m_.y());
}
double Truth::crease_distance_m(double x, double y) const {
  return surface_.crease_distance_m(x - grid_origin_m_.x(), y - grid_origin_m_.y());
}

}  // namespace sparsha::pipeline
