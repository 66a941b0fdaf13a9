// Points as they were measured, for the cross-check, after filters have moved some and taken others away.
#pragma once

#include <Eigen/Core>

#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// The cross-check judges the surface by the points as measured: what a filter moved goes back.
void restore_measured(Cloud& cloud);

/// Puts points that filters took for outliers back before the cross-check, which must judge the surface by all of them.
void add_outliers(Cloud& cloud, const Cloud& removed, const Eigen::Matrix4d& scan_to_grid, Projection& projection);

}  // namespace sparsha::pipeline
