// The points of a cloud as plain numbers, and how far two filters agree.
#pragma once

#include <array>
#include <vector>

#include "pipeline/scan/cloud.h"

namespace sparsha::bench {

/// Coordinates relative to the cloud's origin, in its order.
[[nodiscard]] std::vector<std::array<float, 3>> points_of(const pipeline::Cloud& cloud);

/// Share of `original` on which two filters decide alike, percent; both keep the order of what they keep.
[[nodiscard]] double agreement_percent(const pipeline::Cloud& original, const pipeline::Cloud& a,
                                       const pipeline::Cloud& b);

}  // namespace sparsha::bench
