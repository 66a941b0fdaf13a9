// No more points than the grid can use: an even share of them, each where it was measured.
#pragma once

#include <cstdint>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {

/// keep[i] = 1 for at most `points` points in each cube of the scan frame, `side_m` wide; which ones is decided by a
/// hash of their coordinates, so that the mean of the surface's noise stays. Depends neither on threads nor on the
/// order of the points (of equal points, colour and intensity decide).
[[nodiscard]] std::vector<std::uint8_t> thinned(const Cloud& cloud, double side_m, int points, const Context& context);

}  // namespace sparsha::pipeline
