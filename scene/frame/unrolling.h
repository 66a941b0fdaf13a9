// The mantle of a cylinder or cone laid flat: columns, vases and towers as one height field.
//
// In the unrolled frame x is the length along the mantle to the right, y the length along it upwards, and z the
// distance from it, outwards: lengths on the mantle are true. (0, 0, 0) is on the mantle, at the height of the centre,
// where the picture has its middle. A cylinder's picture repeats after its circumference; a cone's is a sector about
// its apex.
#pragma once

#include <Eigen/Core>

#include "scene/config/unroll.h"

namespace sparsha::scene {

class Unrolling {
 public:
  static constexpr double kLeastSlope_deg = 0.5;  ///< of a cone
  static constexpr double kMostSlope_deg = 60.0;

  /// `config` has everything, and shape is not automatic. `front` is the direction from the axis to the middle of the
  /// picture, any vector that is not parallel to the axis. Scan frame.
  Unrolling(const UnrollConfig& config, const Eigen::Vector3d& front);
  /// Of a scene: the middle of the picture looks where the orientation looks from.
  Unrolling(const UnrollConfig& config, const Eigen::Matrix4d& scan_to_grid);

  /// Scan frame to unrolled frame, metres; within half a turn of the middle of the picture.
  [[nodiscard]] Eigen::Vector3d flat(const Eigen::Vector3d& scan_m) const;
  /// The same place so many turns farther right, which is where the picture repeats.
  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& flat_m, int turns) const;
  /// The angle about the axis from the middle of the picture, radians, counter-clockwise seen from above; beyond half a
  /// turn where the place is.
  [[nodiscard]] double angle(const Eigen::Vector3d& flat_m) const;
  /// Unrolled frame to scan frame, metres.
  [[nodiscard]] Eigen::Vector3d scan(const Eigen::Vector3d& flat_m) const;
  /// Turns directions at a place of the unrolled frame into the scan frame: the columns are right along the mantle,
  /// upwards along it, and outwards.
  [[nodiscard]] Eigen::Matrix3d scan_from_flat(const Eigen::Vector3d& flat_m) const;
  /// The affine that touches the mantle in the middle of the picture: scan frame to unrolled frame, exact there.
  [[nodiscard]] Eigen::Matrix4d scan_to_grid() const;
  /// The circumference after which a cylinder's picture repeats, metres; 0 of a cone.
  [[nodiscard]] double period_m() const;
  [[nodiscard]] bool is_cone() const { return sine_ != 0.0; }

 private:
  Eigen::Vector3d centre_m_, axis_, front_, right_;
  double radius_m_ = 0.0;
  double sine_ = 0.0, cosine_ = 1.0;  // of the angle between mantle and axis, not negative
  double sign_ = 1.0;                 // of a cone: 1 where it widens along the axis
  double apex_m_ = 0.0;               // of a cone: from the apex to the mantle's middle, along the mantle
};

}  // namespace sparsha::scene
