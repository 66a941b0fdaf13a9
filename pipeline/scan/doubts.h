// What makes one doubt that a scan was stored and read as it was meant, each in one sentence with its remedy: the same
// from `info`, `new` and `build`, in memory and streamed.
#pragma once

#include <cstdint>

#include "pipeline/scan/origin.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/steps.h"

namespace sparsha::pipeline {

/// Looks at a scan's valid points and says what is odd in its warnings: coordinates in coarse steps, degrees that no
/// file names (the scan's `degrees` is set); and pieces far apart in its `pieces`. `sample` has seen all `points`,
/// which `each` hands over again where that is needed; of a scan with faces the points are in memory.
void add_doubts(RawScan& scan, const PointSample& sample, std::uint64_t points, const EachPoint& each);

/// The same for a scan in memory.
void add_doubts(RawScan& scan);

}  // namespace sparsha::pipeline
