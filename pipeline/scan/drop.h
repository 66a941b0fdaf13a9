// Points out of a scan in memory, with all that belongs to them.
#pragma once

#include <vector>

#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

/// Takes the points with gone[i] away, and the faces on them. Does not count them.
void drop_points(RawScan& scan, const std::vector<bool>& gone);

}  // namespace sparsha::pipeline
