// Points spread evenly over the faces of a mesh.
#pragma once

#include <cstdint>

#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Area of all faces, square metres. Throws Error{input} where a face names a point that is not there.
[[nodiscard]] double area_of_faces(const Cloud& mesh);

/// One point per square of side `spacing_m` of every face, on the face, where a hash of its corners and `seed` puts it;
/// and the points that are no corners, as they are; without faces, and with colours and intensities between those of
/// the corners where `attributes` says so. Depends on no order of points or faces but in the order of its points.
/// Throws Error{input} as area_of_faces(), and where more than 2^31 points would be made.
[[nodiscard]] Cloud sample_faces(const Cloud& mesh, double spacing_m, std::uint64_t seed, bool attributes = false);

}  // namespace sparsha::pipeline
