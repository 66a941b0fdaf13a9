// The filters a configuration can name, in its order. All keep colour, intensity and the origin.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/error.h"
#include "pipeline/scan/cloud.h"
#include "scene/config.h"

namespace sparsha::pipeline {

/// How many points each kind of filter took away.
struct FilterCounts {
  std::uint64_t filtered = 0;  ///< by crop and voxel
  std::uint64_t outlier = 0;   ///< by outliers
};

/// True when a crop keeps a point of a cloud with that origin.
[[nodiscard]] inline bool is_inside(const CropConfig& crop, const Eigen::Vector3d& origin_m,
                                    const Eigen::Vector3f& point) {
  const Eigen::Vector3d p = origin_m + point.cast<double>();
  return (p.array() >= crop.min_m.array()).all() && (p.array() <= crop.max_m.array()).all();
}

[[nodiscard]] inline bool is_inside(const std::vector<CropConfig>& crops, const Eigen::Vector3d& origin_m,
                                    const Eigen::Vector3f& point) {
  return std::all_of(crops.begin(), crops.end(), [&](const CropConfig& c) { return is_inside(c, origin_m, point); });
}

/// What a filter throws that takes all points away.
[[nodiscard]] Error nothing_left(const std::string& filter);

/// Applies `filters` in order. Faces survive only while no point is taken away. Points that an outlier filter takes
/// away go to `removed_outliers` (positions only, same origin) when it is given: a cross-check must see them. Throws
/// Error{usage} when a voxel leaf is too small for the extent, Error{input} when nothing is left.
FilterCounts apply_filters(Cloud& cloud, const std::vector<FilterConfig>& filters, const Context& context,
                           Cloud* removed_outliers = nullptr);

}  // namespace sparsha::pipeline
