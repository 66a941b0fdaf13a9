// Light on a height field, baked on the processor: which share of a distant light each node sees, what reaches it from
// the whole sky.
#pragma once

#include <cstddef>
#include <vector>

#include "base/threads/thread_pool.h"

namespace sparsha::viewer {

/// A plain lattice of heights, storage index j * nx + i, j upwards; heights in units of the node spacing.
struct Heights {
  int nx = 0;
  int ny = 0;
  std::vector<float> value;
};

/// Share, 0 to 1, of a light at `azimuth_rad` (counted from +x towards +y, where the light comes FROM) and
/// `elevation_rad` above the lattice that each node sees. `softness` is the height in spacings over which a shadow's
/// edge fades. Cost: about 3 ns per node. Heights outside the lattice cast no shadow.
[[nodiscard]] std::vector<float> light_visibility(const Heights& heights, double azimuth_rad, double elevation_rad,
                                                  double softness);

/// Shadow of a light that spans elevations from `elevation_rad` - `half_width_rad` to + `half_width_rad`: the mean of
/// five samples across it.
[[nodiscard]] std::vector<float> soft_shadow(const Heights& heights, double azimuth_rad, double elevation_rad,
                                             double half_width_rad, ThreadPool& pool);

/// Share of an even sky, 0 to 1, that reaches each node (cosine-weighted about the lattice's normal), with heights
/// exaggerated by `exaggeration`. 48 directions.
[[nodiscard]] std::vector<float> sky_visibility(const Heights& heights, double exaggeration, ThreadPool& pool);

/// Mean over a square of (2 * radius + 1)^2 nodes, twice, which is nearly a Gaussian; borders repeat.
[[nodiscard]] std::vector<float> blur(const Heights& heights, int radius);

}  // namespace sparsha::viewer
