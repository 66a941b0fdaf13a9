// Directions from which a cloud nobody has described may be looked at, the likeliest first.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// What the scans show that tells a front.
struct SeenScans {
  std::vector<Eigen::Vector3d> points_m;             ///< an even sample of all scans
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();  ///< sum of triangle area vectors
  double area = 0.0;                                 ///< sum of triangle areas
  bool z_up_format = false;                          ///< formats whose z is up
  bool depth_camera_format = false;                  ///< formats that depth cameras write in their own frame
  bool range_images = false;                         ///< all scans are images of a camera in the origin
  bool rasters = false;                              ///< all scans are grids of heights over x and y

  void look_at(const RawScan& scan, double metres);
  /// Keeps the points in the box.
  void crop(const CropConfig& box);

 private:
  bool any_ = false;
};

struct View {
  Eigen::Vector3d look_from = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  std::string reason;
  bool evident = false;  ///< the points' own form tells this side, not custom

  [[nodiscard]] bool oblique() const { return (look_from.array() != 0.0).count() > 1; }
};

/// Corners of the 1st to 99th percentile box, metres: a far outlier says nothing about the object.
struct InnerBox {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};
[[nodiscard]] InnerBox inner_box(const std::vector<Eigen::Vector3d>& points_m);

/// The guess, then the axes and both sides of the thinnest direction, each once. There must be points.
[[nodiscard]] std::vector<View> likely_views(const SeenScans& seen);

}  // namespace sparsha::pipeline
