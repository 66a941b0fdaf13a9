#include "pipeline/scan/placement.h"

#include <limits>

namespace sparsha::pipeline {

Placement place(const scene::ScanConfig& config, double scale) {
  Placement placement;
  placement.turn_and_scale = config.pose.topLeftCorner<3, 3>() * scale;
  placement.shift_m = config.pose.topRightCorner<3, 1>();
  placement.trivial = placement.turn_and_scale.isIdentity(0.0) && placement.shift_m.isZero(0.0);
  return placement;
}

double metres_in_unit(const scene::ScanConfig& config, const std::optional<scene::LengthUnit>& of_file) {
  if (config.units.unit == scene::LengthUnit::longest_side) return 0.0;
  if (config.units.unit != scene::LengthUnit::automatic) return scene::metres_in(config.units.unit);
  return of_file ? scene::metres_in(*of_file) : 1.0;
}

Region region_of(const scene::ScanConfig& config, const scene::CropConfig& box) {
  return [config, box](const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       const std::optional<scene::LengthUnit>& unit) {
    const double scale = metres_in_unit(config, unit);
    if (scale == 0.0) return true;
    const Placement placement = place(config, scale);
    Eigen::Vector3d least = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d most = -least;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p =
          placement({(corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                     (corner & 4) != 0 ? high.z() : low.z()});
      least = least.cwiseMin(p);
      most = most.cwiseMax(p);
    }
    // The filter sees points that were rounded to float.
    constexpr double kRounding = 1e-6;
    const double margin = kRounding * (least.cwiseAbs().maxCoeff() + most.cwiseAbs().maxCoeff());
    return !((least.array() - margin > box.max_m.array()).any() || (most.array() + margin < box.min_m.array()).any());
  };
}

}  // namespace sparsha::pipeline
