// What the depth scan will see from the chosen side: size, coverage and a small picture of the heights, in a few
// milliseconds.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "viewer/cloud/point_view.h"
#include "viewer/cloud/splat.h"

namespace sparsha::viewer {

struct DepthPreview {
  bool any = false;                                 ///< false: no point is left to look at
  Eigen::Vector3d low_m = Eigen::Vector3d::Zero();  ///< grid frame: bounds of what is seen, without strays
  Eigen::Vector3d high_m = Eigen::Vector3d::Zero();
  double coverage = 0.0;  ///< cells with a point / all
  int nx = 0, ny = 0;
  double cell_m = 0.0;
  std::vector<float> height_m;  ///< nx * ny from the bottom left, over low_m.z(); NaN where no point is

  [[nodiscard]] Eigen::Vector3d size_m() const { return high_m - low_m; }
};

/// The crop as `points` are stored.
[[nodiscard]] SplatCrop crop_of(const ScanSetup& setup, const PointView& points);

[[nodiscard]] bool same_crop(const std::optional<scene::CropConfig>& a, const std::optional<scene::CropConfig>& b);

/// Looks at `at_most` points, evenly chosen. Cells are as wide as that many points can fill, and at least the
/// cloud's spacing times 1.5.
[[nodiscard]] DepthPreview preview_of(const PointView& points, const ScanSetup& setup, std::size_t at_most);

/// The heights as a small shaded picture, RGBA, first row at the TOP; cells without a point are marked.
[[nodiscard]] std::vector<std::uint32_t> shade(const DepthPreview& preview);

}  // namespace sparsha::viewer
