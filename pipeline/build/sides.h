// The sides of an object in the report, by which another front is chosen.
#pragma once

#include <Eigen/Core>

#include "pipeline/report/report.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// About 65 000 points spread evenly over the faces of a mesh, whose corners alone would be a picture of dots; the mesh
/// itself where its faces have no area.
[[nodiscard]] Cloud places_on_faces(const Cloud& mesh);

/// Fills `report.sides` from `report.kept_m` where the view of `scan_to_grid` shows one side of several: more than a
/// quarter of the points is hidden from it.
void add_sides(const Eigen::Matrix4d& scan_to_grid, Report& report);

}  // namespace sparsha::pipeline
