// Whether a plane that is taken away is a floor beside the object, or runs through the object itself.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/filter/filter.h"
#include "pipeline/filter/point_test.h"

namespace sparsha::pipeline {

/// Of the object's surface, the share that goes with the plane, estimated: what is taken away inside the outline of
/// what stays (other points lie around it on most sides) or close below the plane where nothing stands above it, over
/// that and what stays. Counted in a plan of the plane. About a floor, whose points lie around the object, it is small;
/// 1 where nothing stays. `points` are spread evenly over the surface (PlaneSample), relative to the cloud's origin,
/// metres.
[[nodiscard]] double share_of_object(const std::vector<Eigen::Vector3f>& points, const PlaneCut& cut);

/// Warns when most of the points lie in the plane or go, or when the plane runs through the object (share_of_object()).
/// `before`: points before the filter.
void warn_of_plane(const FilterStep& step, std::uint64_t before, Progress& progress);

}  // namespace sparsha::pipeline
