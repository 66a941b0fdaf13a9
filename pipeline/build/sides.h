// The sides of an object in the report, by which another front is chosen.
#pragma once

#include <Eigen/Core>

#include "pipeline/report/report.h"

namespace sparsha::pipeline {

/// Fills `report.sides` from `report.kept_m` where the view of `scan_to_grid` shows one side of several: more than a
/// quarter of the points is hidden from it.
void add_sides(const Eigen::Matrix4d& scan_to_grid, Report& report);

}  // namespace sparsha::pipeline
