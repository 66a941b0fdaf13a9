// Places of a scan with descriptors (FPFH) that do not depend on its pose: what a first guess is found from.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pipeline/register/surface.h"

namespace sparsha::pipeline {

/// Three histograms of 11 bins: angles between a place's normal and those around it.
using Descriptor = std::array<float, 33>;

struct ScanFeatures {
  std::vector<Eigen::Vector3d> points;   ///< elements of the surface they were made from
  std::vector<Eigen::Vector3d> normals;  ///< all on one side of the surface
  std::vector<Descriptor> descriptors;
  /// Which side is unknown: all normals may have to be turned.
  bool any_side = false;
};

/// About `most` places that are not on the border of `surface`, described by what lies within `radius_m`
/// (pcl::FPFHEstimation). One thread; the same result every time.
[[nodiscard]] ScanFeatures features_of(const StationSurface& surface, std::size_t most, double radius_m);

/// As if all normals faced the other side.
[[nodiscard]] ScanFeatures turned(ScanFeatures features);

}  // namespace sparsha::pipeline
