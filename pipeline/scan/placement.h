// Where the points of a file lie in the scan frame: the unit of its numbers and the pose of its scan.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pipeline/scan/reader.h"
#include "scene/config/filters.h"
#include "scene/config/scans.h"
#include "scene/frame/length_unit.h"

namespace sparsha::pipeline {

/// pose * units for one scan.
struct Placement {
  Eigen::Matrix3d turn_and_scale = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
  bool trivial = true;

  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& p) const {
    return trivial ? p : Eigen::Vector3d(turn_and_scale * p + shift_m);
  }
};

Placement place(const scene::ScanConfig& config, double scale);

/// Metres in a unit of the file; 0 when the points themselves decide.
double metres_in_unit(const scene::ScanConfig& config, const std::optional<scene::LengthUnit>& of_file);

/// Tells boxes of the file's coordinates that may reach into `box`, which has metres of the scan frame.
Region region_of(const scene::ScanConfig& config, const scene::CropConfig& box);

}  // namespace sparsha::pipeline
