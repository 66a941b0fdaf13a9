// The truth in the grid frame.
#include <cmath>

#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

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
  constexpr double kSpare = 0.25;  // of a spacing, so that rounding at 5e6 m cannot lose the last node
  return {grid_origin_m_.x(), grid_origin_m_.y(), lattice_.x_m(lattice_.nx - 1) + kSpare * lattice_.spacing_m,
          lattice_.y_m(lattice_.ny - 1) + kSpare * lattice_.spacing_m};
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
