// Windows of nodes for reliefs, tangent discs for closed objects.
#include "pipeline/projection/measure_rows.h"

#include <algorithm>
#include <cmath>

#include "pipeline/projection/crowded.h"
#include "pipeline/projection/fit_rows.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

// The columns that hold the points of a window of the nodes' bins.
BinWindow columns_of(const BinLattice& nodes, const BinWindow& window, const BinLattice& columns) {
  const BinLocator bins(nodes);
  const BinLocator locator(columns);
  const auto row_at = [&](int row) {
    const double y = static_cast<double>(bins.y_shift_m) + row * nodes.spacing_m;
    return (y - static_cast<double>(locator.y_shift_m)) / columns.spacing_m;
  };
  BinWindow all = BinWindow::all(columns);
  all.first_row = std::clamp(static_cast<int>(std::floor(row_at(window.first_row))) - 1, 0, columns.bins_y() - 1);
  all.last_row =
      std::clamp(static_cast<int>(std::ceil(row_at(window.last_row))) + 1, all.first_row + 1, columns.bins_y());
  return all;
}

std::vector<std::uint8_t> fit_disc_rows(const TangentDiscs& discs, const ProjectionPlan& plan, int first_row,
                                        const Context& context, scene::DepthGrid& rows) {
  DiscNodeKernel shared = node_kernel(discs, plan.bins, plan.rule.noise_m, plan.discs->lines);
  shared.nx = static_cast<std::size_t>(rows.lattice.nx);
  std::vector<std::uint8_t> verdicts(rows.lattice.count());
  context.pool.for_ranges(static_cast<std::size_t>(rows.lattice.ny), 4, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    const auto scratch = make_buffer<float>(DiscNodeKernel::kScratch);
    DiscNodeKernel kernel = shared;
    kernel.scratch = scratch.get();
    for (std::size_t j = begin; j < end; ++j) {
      const std::size_t at = j * kernel.nx;
      fastest_kernels().fit_disc_nodes(kernel, static_cast<std::size_t>(first_row) + j, rows.height_m.data() + at,
                                       verdicts.data() + at);
      for (std::size_t node = at; node < at + kernel.nx; ++node) {
        constexpr unsigned kHeight = DiscNodeKernel::kMeasured | DiscNodeKernel::kAway | DiscNodeKernel::kEdge;
        if ((verdicts[node] & kHeight) != 0) {
          rows.state[node] = scene::NodeState::measured;
        } else {
          rows.height_m[node] = scene::kUnknownHeight;
        }
      }
    }
  });
  return verdicts;
}

// Discs that face away cover nothing from now on.
void leave_out_away(TangentDiscs& discs) {
  const auto length = static_cast<std::size_t>(discs.columns.bins_x()) + 1;
  for (int row = discs.window.first_row; row < discs.window.last_row; ++row) {
    const std::uint32_t* start = discs.start.get() + static_cast<std::size_t>(row) * length;
    for (std::uint32_t d = start[0]; d < start[length - 1]; ++d) {
      if (discs.facing(d) < 0.0F) discs.radius2[d] = 0.0F;
    }
  }
}

}  // namespace

std::vector<std::uint8_t> measure_rows(const OrientedPoints& points, const std::vector<std::uint8_t>& skip,
                                       const ProjectionPlan& plan, const BinWindow& window, int first_row,
                                       const Context& context, scene::DepthGrid& rows, MemoryStore* store) {
  if (!plan.discs) {
    Bins bins = sort_into_bins(points, skip, plan.bins, window, context.pool, store);
    leave_out_repeats(bins, window, context.pool);
    leave_out_crowd(bins, window, context.pool);
    fit_rows(bins, plan.rule, plan.gap_m, first_row, context, rows);
    return {};
  }
  const BinLattice columns = disc_columns(plan.bins, *plan.discs);
  // A room's walls that face away hide nothing.
  const bool through = plan.facing && plan.facing->sees_through();
  TangentDiscs discs = find_discs(points, skip, columns, columns_of(plan.bins, window, columns), *plan.discs, through,
                                  context.pool, store);
  context.progress.throw_if_cancelled();
  if (plan.facing) plan.facing->set_facing(discs, context.pool);
  if (through) leave_out_away(discs);
  return fit_disc_rows(discs, plan, first_row, context, rows);
}

int bins_beyond(const ProjectionPlan& plan) {
  const int scattered = plan.scatter.bins_needed(plan.lattice.spacing_m);
  if (!plan.discs) return widest_look(plan.rule) + scattered;
  return scattered + static_cast<int>(std::ceil(disc_reach_m(*plan.discs) / plan.lattice.spacing_m)) + 2;
}

void add_verdicts(const std::vector<std::uint8_t>& verdicts, Projection& projection) {
  for (const std::uint8_t verdict : verdicts) {
    projection.nodes_doubtful += (verdict & DiscNodeKernel::kDoubtful) != 0 ? 1 : 0;
    projection.nodes_unsure += projection.closed && (verdict & DiscNodeKernel::kUnsure) != 0 ? 1 : 0;
  }
}

}  // namespace sparsha::pipeline
