// What lies over the nodes of one side: every layer of discs that faces it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/charts/charts.h"
#include "pipeline/charts/sided_discs.h"
#include "pipeline/projection/simd/kernels.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// Layers of the nodes of a lattice in a side's chart frame. Node (i, j) is at u = (first_u + i) * spacing, v alike.
struct SideLayers {
  scene::Side side = scene::Side::front;
  int first_u = 0, first_v = 0;
  int nx = 0, ny = 0;
  std::vector<std::uint32_t> start;  ///< nx * ny + 1 values: layers of node n are [start[n], start[n + 1])
  std::vector<DiscLayer> layers;     ///< the highest of a node first
};

/// The discs that face a side, in columns of its chart frame, and the nodes that they may cover; these have no layers
/// yet.
struct SideDiscs {
  SideLayers nodes;
  TangentDiscs discs;
};
/// Throws Error{usage} when the side would have too many nodes.
[[nodiscard]] SideDiscs discs_of_side(const SidedDiscs& discs, scene::Side side, double spacing_m,
                                      const ChartRule& rule);

/// Layers whose surface faces the side by at least rule.least_facing. `disc_rule` is that of the discs.
[[nodiscard]] SideLayers find_layers(SideDiscs&& side, const DiscRule& disc_rule, double spacing_m,
                                     const ChartRule& rule, const Context& context);

}  // namespace sparsha::pipeline
