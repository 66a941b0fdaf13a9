// Points that lie farther from their neighbours than the others do (Rusu et al. 2008, statistical outlier removal), or
// than a given radius.
#pragma once

#include <cstdint>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// keep[i] = 0 where the mean distance of point i to its neighbours exceeds mean + sigma * standard deviation of all
/// such distances. Depends neither on threads nor on the order of the points.
[[nodiscard]] std::vector<std::uint8_t> statistical_inliers(const Cloud& cloud, const scene::OutlierConfig& config,
                                                            const Context& context);

/// The same by pcl::StatisticalOutlierRemoval. Throws Cancelled.
[[nodiscard]] std::vector<std::uint8_t> statistical_inliers_by_pcl(const Cloud& cloud,
                                                                   const scene::OutlierConfig& config,
                                                                   const Progress& progress);

/// keep[i] = 0 where fewer than `neighbours` other points lie within the radius of point i, its border included.
/// Distances are FLANN's. Depends neither on threads nor on the order of the points.
[[nodiscard]] std::vector<std::uint8_t> radius_inliers(const Cloud& cloud, const scene::RadiusOutlierConfig& config,
                                                       const Context& context);

/// The same by pcl::RadiusOutlierRemoval. Throws Cancelled.
[[nodiscard]] std::vector<std::uint8_t> radius_inliers_by_pcl(const Cloud& cloud,
                                                              const scene::RadiusOutlierConfig& config,
                                                              const Progress& progress);

}  // namespace sparsha::pipeline
