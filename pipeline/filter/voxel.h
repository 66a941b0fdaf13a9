// One point a voxel: the centroid of the points in it, as pcl::VoxelGrid has it, without its overflow of indices.
#pragma once

#include <cstdint>

#include "pipeline/base/progress.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// Replaces the points by their voxels' centroids, colours and intensities by their means, ordered by z, y, x of the
/// voxel. Voxels are multiples of `leaf_m` in the scan frame, counted in 64 bits. Sums are integers, so that the result
/// does not depend on the order of the points. Throws Error{usage} when the leaf is below the points' own precision.
void thin_to_voxels(Cloud& cloud, double leaf_m, Progress& progress);

}  // namespace sparsha::pipeline
