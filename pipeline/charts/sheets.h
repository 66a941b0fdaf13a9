// Layers of neighbouring nodes that go on into each other are a sheet.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/charts/layers.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

struct SideSheets {
  std::vector<scene::Sheet> sheets;  ///< by their first node
  std::uint64_t small = 0;           ///< sheets that were left out
  std::uint64_t small_nodes = 0;     ///< and their nodes
};

/// `noise_m` is that of the points. Sheets that would come to lie over themselves, as a helix does, are cut.
[[nodiscard]] SideSheets link_sheets(const SideLayers& layers, double spacing_m, double noise_m, const ChartRule& rule);

}  // namespace sparsha::pipeline
