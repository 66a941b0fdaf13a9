// Clouds that are an image of a depth camera, told by the order of their points.
#pragma once

#include "pipeline/scan/reader.h"
#include "pipeline/scan/runs.h"

namespace sparsha::pipeline {

/// True when the points, as they follow each other in the file, are the pixels of a pinhole camera that stands in the
/// origin and looks along +z: x / z and y / z go on by whole steps of an even raster along its rows or columns, and x
/// and y do not, as they do in a grid seen from far away. Gaps in the image do no harm. Points in another order are an
/// image when x / z and y / z take few places, those of columns and rows, and x and y many. `scan` may hold a sample of
/// the points; `runs` are of the file.
[[nodiscard]] bool is_range_image(const RawScan& scan, const PointRuns& runs);

}  // namespace sparsha::pipeline
