#pragma once

#include <filesystem>
#include <vector>

namespace sparsha::bench {

/// Strokes over the outlines of scenes, at every zoom, with what lies beyond continued, falling away and after a rim:
/// how many still feel force 10 mm beyond, are stopped, or lose more than a newton in a tick. Prints a table. Without
/// scenes two of formulas.
bool write_edges(const std::vector<std::filesystem::path>& scenes, int strokes_per_zoom);

}  // namespace sparsha::bench
