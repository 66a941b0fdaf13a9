// More than is needed goes into the key: one that differs costs time, one that does not would cost the scene.
#include "pipeline/build/kept_tiles.h"

#include <span>
#include <string>

#include <fmt/format.h>

#include "base/files/files.h"
#include "base/text/text.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {
namespace {

// A hash of all that decides heights and states.
std::string key_of_tiles(const BuildOptions& options, const scene::Config& config,
                         const std::vector<scene::ScanSource>& sources, const ProjectionPlan& plan) {
  scene::Config heights;
  heights.scans = config.scans;
  heights.filters = config.filters;
  heights.orientation = config.orientation;
  heights.grid = config.grid;
  heights.haptics = config.haptics;
  std::string text = options.program + "\n" + scene::to_yaml(heights);
  for (const scene::ScanSource& source : sources) text += source.sha256 + "\n";
  const scene::Lattice& lattice = plan.lattice;
  text +=
      fmt::format("{} {} {} {} {}\n", options.grid_only, lattice.nx, lattice.ny, plan.discs.has_value(), plan.closed);
  for (const double number : {lattice.spacing_m, lattice.origin_m.x(), lattice.origin_m.y(), lattice.origin_m.z(),
                              plan.point_spacing_m, plan.front_spacing_m, plan.gap_m})
    text += exact_text(number) + "\n";
  return sha256(std::as_bytes(std::span<const char>(text)));
}

}  // namespace

std::optional<FinishedTiles> open_kept_tiles(const BuildOptions& options, const scene::Config& config,
                                             const std::vector<scene::ScanSource>& sources, const ProjectionPlan& plan,
                                             Progress& progress) {
  if (options.finished_tiles.empty()) return std::nullopt;
  std::optional<FinishedTiles> tiles;
  tiles.emplace(options.finished_tiles, key_of_tiles(options, config, sources, plan));
  if (tiles->was_of_another())
    progress.warn(
        "what an earlier build has kept is of other scans, another configuration or another version of this program; "
        "this one begins anew");
  progress.begin(fmt::format("project ({} tiles are there)", tiles->found()));
  return tiles;
}

}  // namespace sparsha::pipeline
