// The discs that face a side become discs of its chart frame; the kernel of closed objects tells their layers.
#include "pipeline/charts/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

// Discs that face the side less than its nodes have to: they carry the surface to the nodes at its end.
constexpr double kBelow = 0.15;
constexpr double kMostNodes = 2147483648.0;

// Records of the discs that face the side, see kDiscRecord.
std::vector<float> records_of(const SidedDiscs& discs, const scene::SideAxes& axes, float least) {
  const auto u = static_cast<std::size_t>(axes.u);
  const auto v = static_cast<std::size_t>(axes.v);
  const auto w = static_cast<std::size_t>(axes.w);
  const auto sign = static_cast<float>(axes.sign);
  std::size_t count = 0;
  for (std::size_t d = 0; d < discs.count; ++d) count += sign * discs.discs[d].normal[w] >= least ? 1 : 0;
  std::vector<float> records;
  records.reserve(kDiscRecord * count);
  for (std::size_t d = 0; d < discs.count; ++d) {
    const SidedDisc& disc = discs.discs[d];
    const float facing = sign * disc.normal[w];
    if (!(facing >= least)) continue;
    const float per = 1.0F / facing;
    for (const float value : {disc.foot[u], disc.foot[v], sign * disc.foot[w], -disc.normal[u] * per,
                              -disc.normal[v] * per, disc.above * per, disc.radius2, 1.0F}) {
      records.push_back(value);
    }
  }
  return records;
}

SideLayers empty_layers(const SidedDiscs& discs, scene::Side side, double spacing_m) {
  const scene::SideAxes axes = scene::SideAxes::of(side);
  const auto first = [&](int axis) { return std::floor(discs.min_m[axis] / spacing_m) - 1.0; };
  const auto nodes = [&](int axis) { return std::ceil(discs.max_m[axis] / spacing_m) + 2.0 - first(axis); };
  if (nodes(axes.u) * nodes(axes.v) > kMostNodes) {
    throw usage_error("a side of the object would have more than " + std::to_string(1U << 31U) + " nodes",
                      "a larger grid.spacing_mm, or filters that take away what is not the object");
  }
  return {side,
          static_cast<int>(first(axes.u)),
          static_cast<int>(first(axes.v)),
          static_cast<int>(nodes(axes.u)),
          static_cast<int>(nodes(axes.v)),
          {},
          {}};
}

BinLattice lattice_of(const SideLayers& nodes, double spacing_m) {
  return {nodes.nx, nodes.ny, spacing_m, nodes.first_u * spacing_m, nodes.first_v * spacing_m};
}

/// Layers of one row of nodes.
struct Row {
  std::vector<std::uint32_t> count;
  std::vector<DiscLayer> layers;
};

}  // namespace

SideDiscs discs_of_side(const SidedDiscs& discs, scene::Side side, double spacing_m, const ChartRule& rule) {
  SideDiscs result{empty_layers(discs, side, spacing_m), {}};
  result.discs =
      arrange_discs(records_of(discs, scene::SideAxes::of(side), static_cast<float>(rule.least_facing - kBelow)),
                    disc_columns(lattice_of(result.nodes, spacing_m), discs.rule), discs.rule);
  return result;
}

SideLayers find_layers(SideDiscs&& side, const DiscRule& disc_rule, double spacing_m, const ChartRule& rule,
                       const Context& context) {
  const TangentDiscs arranged = std::move(side.discs);
  SideLayers result = std::move(side.nodes);
  const BinLattice nodes = lattice_of(result, spacing_m);
  const DiscNodeKernel shared = node_kernel(arranged, nodes, disc_rule.noise_m, disc_rule.lines);
  const auto most_slope2 = static_cast<float>(1.0 / (rule.least_facing * rule.least_facing) - 1.0);

  std::vector<Row> rows(static_cast<std::size_t>(result.ny));
  context.pool.for_ranges(rows.size(), 4, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    const auto scratch = make_buffer<float>(DiscNodeKernel::kScratch);
    DiscNodeKernel kernel = shared;
    kernel.scratch = scratch.get();
    std::array<DiscLayer, DiscNodeKernel::kMostLayers> here;
    for (std::size_t j = begin; j < end; ++j) {
      rows[j].count.resize(kernel.nx);
      for (std::size_t i = 0; i < kernel.nx; ++i) {
        const std::size_t found = fastest_kernels().find_disc_layers(kernel, i, j, here.data());
        for (std::size_t k = 0; k < found; ++k) {
          const DiscLayer& layer = here[k];
          if (layer.slope_x * layer.slope_x + layer.slope_y * layer.slope_y > most_slope2) continue;
          rows[j].layers.push_back(layer);
          ++rows[j].count[i];
        }
      }
    }
  });
  std::size_t total = 0;
  for (const Row& row : rows) total += row.layers.size();
  if (static_cast<double>(total) > kMostNodes) throw usage_error("too many nodes", "a larger grid.spacing_mm");
  result.layers.reserve(total);
  result.start.reserve(static_cast<std::size_t>(result.nx) * rows.size() + 1);
  result.start.push_back(0);
  for (Row& row : rows) {
    for (const std::uint32_t count : row.count) result.start.push_back(result.start.back() + count);
    result.layers.insert(result.layers.end(), row.layers.begin(), row.layers.end());
    row = {};
  }
  return result;
}

}  // namespace sparsha::pipeline
