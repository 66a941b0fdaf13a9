// Discs once, then each side's layers and sheets, and what noise is left.
#include "pipeline/charts/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/charts/layers.h"
#include "pipeline/charts/sheets.h"
#include "pipeline/charts/sided_discs.h"
#include "pipeline/charts/smooth_sheets.h"

namespace sparsha::pipeline {
namespace {

double node_spacing_m(const scene::GridConfig& config, const SidedDiscs& discs, double resolution_m) {
  if (config.spacing_m > 0.0) return config.spacing_m;
  if (config.size > 1) return (discs.max_m - discs.min_m).maxCoeff() / (config.size - 1);
  return std::max(discs.point_spacing_m, resolution_m);
}

}  // namespace

ChartResult make_charts(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& config,
                        double resolution_m, const Context& context, const ChartRule& rule) {
  SidedDiscs discs = find_sided_discs(cloud, scan_to_grid, context);
  if (config.noise_m) discs.rule.noise_m = *config.noise_m;
  ChartResult result;
  result.point_spacing_m = discs.point_spacing_m;
  result.noise_m = discs.rule.noise_m;
  result.discs = discs.found;
  result.discs_undecided = discs.undecided;
  result.discs_thin = discs.thin;
  result.discs_thin_agreed = discs.thin_agreed;
  result.mixed_share = discs.mixed.share();
  result.discs_outside = discs.outside;
  result.charts.origin_m = discs.origin_m;
  result.charts.spacing_m = node_spacing_m(config, discs, resolution_m);

  std::array<SideDiscs, scene::kSides> of_sides;
  context.pool.for_ranges(scene::kSides, 1, [&](std::size_t side, std::size_t) {
    of_sides[side] = discs_of_side(discs, static_cast<scene::Side>(side), result.charts.spacing_m, rule);
  });
  discs.discs.reset();
  std::array<SideLayers, scene::kSides> layers;
  for (std::size_t side = 0; side < scene::kSides; ++side) {
    layers[side] = find_layers(std::move(of_sides[side]), discs.rule, result.charts.spacing_m, rule, context);
    result.layers += layers[side].layers.size();
  }
  std::array<SideSheets, scene::kSides> sheets;
  context.pool.for_ranges(scene::kSides, 1, [&](std::size_t side, std::size_t) {
    sheets[side] = link_sheets(layers[side], result.charts.spacing_m, result.noise_m, rule);
    layers[side] = {};
  });
  for (SideSheets& of_side : sheets) {
    result.small_sheets += of_side.small;
    result.small_sheet_nodes += of_side.small_nodes;
    std::move(of_side.sheets.begin(), of_side.sheets.end(), std::back_inserter(result.charts.sheets));
  }
  if (result.charts.sheets.empty()) {
    throw input_error(
        {},
        fmt::format("nothing of the whole object is left on nodes that are {} apart; its points are {} apart",
                    length_text(result.charts.spacing_m), length_text(result.point_spacing_m)),
        fmt::format("a grid.spacing_mm of about {:.2g}", 1e3 * result.point_spacing_m));
  }
  smooth_sheets(result.charts.sheets, result.charts.spacing_m, result.noise_m, context);
  return result;
}

}  // namespace sparsha::pipeline
