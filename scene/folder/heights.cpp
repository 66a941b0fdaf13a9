#include "scene/folder/heights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/error.h"
#include "base/text/text.h"
#include "scene/scene.h"

namespace sparsha::scene {

void read_heights(const std::filesystem::path& folder, const LayerRegion& region, const SceneDescription& scene,
                  Layers& layers) {
  DepthGrid& grid = layers.grid;
  const std::filesystem::path file = folder / "height.tif";
  read_layer(file, region, std::span<float>(grid.height_m));
  std::vector<std::uint8_t> mask(grid.lattice.count(), 0);
  read_layer(folder / "mask.tif", region, std::span<std::uint8_t>(mask));
  // Heights are rounded to 32 bits. A coarser level reaches beyond the finest by less than its cell, where its heights
  // go on as steeply as they came.
  const double base = grid.lattice.origin_m.z();
  const double low = scene.height_min_m - base, high = scene.height_max_m - base;
  const bool finest = region.level_nx == scene.levels.front().nx && region.level_ny == scene.levels.front().ny;
  const double rounding =
      1e-15 * std::max({std::abs(base), std::abs(scene.height_min_m), std::abs(scene.height_max_m)});
  const double slack =
      1e-6 * std::max({high - low, std::abs(low), std::abs(high)}) + rounding + (finest ? 0.0 : high - low);
  for (std::size_t n = 0; n < mask.size(); ++n) {
    // A damaged mask must not claim a height that is not there.
    const bool known = mask[n] == 1 || mask[n] == 2;
    const auto height = static_cast<double>(grid.height_m[n]);
    const bool finite = std::isfinite(height);
    if (known && finite && (height < low - slack || height > high + slack)) {
      const auto nx = static_cast<std::size_t>(region.nx);
      throw input_error(
          file.string(),
          fmt::format("node ({}, {}) lies at z = {} m", region.i0 + static_cast<int>(n % nx),
                      region.j0 + static_cast<int>(n / nx), base + height),
          fmt::format("heights from {} to {} m, as scene.yaml says; the file is damaged or of another scene",
                      scene.height_min_m, scene.height_max_m));
    }
    if (known && !finite) ++layers.not_a_number;
    grid.state[n] = known && finite ? static_cast<NodeState>(mask[n]) : NodeState::unknown;
    if (grid.state[n] == NodeState::unknown) grid.height_m[n] = kUnknownHeight;
  }
}

std::string doubt_of_heights(const Layers& layers, int level) {
  const std::uint64_t wrong = layers.not_a_number;
  if (wrong == 0) return {};
  const auto known =
      wrong + static_cast<std::uint64_t>(std::count_if(layers.grid.state.begin(), layers.grid.state.end(),
                                                       [](NodeState state) { return state != NodeState::unknown; }));
  return fmt::format(
      "{} of the {} known nodes of level {} have heights that are not numbers; they are taken as unknown",
      count_text(wrong), count_text(known), level);
}

}  // namespace sparsha::scene
