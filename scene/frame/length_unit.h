// What one unit of a scan's coordinates is in metres.
#pragma once

#include "scene/config/scans.h"

namespace sparsha::scene {

/// Metres in one unit; 1 for automatic and for longest_side, of which only the scan knows it.
[[nodiscard]] double metres_in(LengthUnit unit);

}  // namespace sparsha::scene
