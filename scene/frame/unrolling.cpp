#include "scene/frame/unrolling.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "base/error.h"

namespace sparsha::scene {

Unrolling::Unrolling(const UnrollConfig& config, const Eigen::Vector3d& front) {
  if (!config.axis || !config.centre_m || !config.radius_m || config.shape == UnrollConfig::Shape::automatic)
    throw Error(ErrorKind::failure, {}, "the mantle that is unrolled is not known",
                "axis, centre_m, radius_m and shape");
  centre_m_ = *config.centre_m;
  constexpr double kUnit = 1e-12;  // a unit vector stays as it is
  axis_ = std::abs(config.axis->norm() - 1.0) < kUnit ? *config.axis : config.axis->normalized();
  radius_m_ = *config.radius_m;
  const Eigen::Vector3d across = front - front.dot(axis_) * axis_;
  if (!(across.norm() > 1e-6 * front.norm()))
    throw usage_error("unroll: orientation.look_from is parallel to the axis", "a view from beside the axis");
  front_ = across.normalized();
  right_ = axis_.cross(front_);
  if (config.shape == UnrollConfig::Shape::cylinder) return;
  const double slope = config.slope_rad.value_or(0.0);
  if (slope == 0.0) throw Error(ErrorKind::failure, {}, "the slope of the cone is not known", "slope_deg");
  sign_ = slope > 0.0 ? 1.0 : -1.0;
  sine_ = std::sin(std::abs(slope));
  cosine_ = std::cos(slope);
  apex_m_ = radius_m_ / sine_;
}

Unrolling::Unrolling(const UnrollConfig& config, const Eigen::Matrix4d& scan_to_grid)
    : Unrolling(config, Eigen::Vector3d(scan_to_grid.block<1, 3>(2, 0).transpose())) {}

Eigen::Vector3d Unrolling::flat(const Eigen::Vector3d& scan_m) const {
  const Eigen::Vector3d from = scan_m - centre_m_;
  const double up = from.dot(axis_), ahead = from.dot(front_), beside = from.dot(right_);
  const double out = std::hypot(ahead, beside);
  const double around = out > 0.0 ? std::atan2(beside, ahead) : 0.0;
  if (!is_cone()) return {radius_m_ * around, up, out - radius_m_};
  // From the apex: along the axis to where the cone widens, then along the mantle.
  const double along_axis = sign_ * up + apex_m_ * cosine_;
  const double along = along_axis * cosine_ + out * sine_;
  const double sector = around * sine_;
  return {along * std::sin(sector), sign_ * (along * std::cos(sector) - apex_m_), out * cosine_ - along_axis * sine_};
}

double Unrolling::angle(const Eigen::Vector3d& flat_m) const {
  if (!is_cone()) return flat_m.x() / radius_m_;
  return std::atan2(flat_m.x(), sign_ * flat_m.y() + apex_m_) / sine_;
}

Eigen::Vector3d Unrolling::turned(const Eigen::Vector3d& flat_m, int turns) const {
  if (!is_cone()) return flat_m + Eigen::Vector3d(turns * period_m(), 0.0, 0.0);
  const double sector = turns * 2.0 * std::numbers::pi * sine_;
  const double x = flat_m.x(), y = sign_ * flat_m.y() + apex_m_;
  return {x * std::cos(sector) + y * std::sin(sector), sign_ * (y * std::cos(sector) - x * std::sin(sector) - apex_m_),
          flat_m.z()};
}

Eigen::Vector3d Unrolling::scan(const Eigen::Vector3d& flat_m) const {
  const double around = angle(flat_m);
  double out = radius_m_ + flat_m.z(), up = flat_m.y();
  if (is_cone()) {
    const double along = std::hypot(flat_m.x(), sign_ * flat_m.y() + apex_m_);
    out = along * sine_ + flat_m.z() * cosine_;
    up = sign_ * (along * cosine_ - flat_m.z() * sine_ - apex_m_ * cosine_);
  }
  return centre_m_ + up * axis_ + out * (std::cos(around) * front_ + std::sin(around) * right_);
}

Eigen::Matrix3d Unrolling::scan_from_flat(const Eigen::Vector3d& flat_m) const {
  const double around = angle(flat_m);
  const Eigen::Vector3d radial = std::cos(around) * front_ + std::sin(around) * right_;
  Eigen::Matrix3d turn;
  turn.col(0) = axis_.cross(radial);
  turn.col(1) = cosine_ * axis_ + sign_ * sine_ * radial;
  turn.col(2) = cosine_ * radial - sign_ * sine_ * axis_;
  if (!is_cone()) return turn;
  // The sector's own right and up are turned about the apex.
  const double sector = sign_ * around * sine_;
  Eigen::Matrix3d sector_turn = Eigen::Matrix3d::Identity();
  sector_turn << std::cos(sector), -std::sin(sector), 0.0, std::sin(sector), std::cos(sector), 0.0, 0.0, 0.0, 1.0;
  return turn * sector_turn;
}

Eigen::Matrix4d Unrolling::scan_to_grid() const {
  const Eigen::Matrix3d turn = scan_from_flat(Eigen::Vector3d::Zero());
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = turn.transpose();
  m.topRightCorner<3, 1>() = -turn.transpose() * scan(Eigen::Vector3d::Zero());
  return m;
}

double Unrolling::period_m() const { return is_cone() ? 0.0 : 2.0 * std::numbers::pi * radius_m_; }

}  // namespace sparsha::scene
