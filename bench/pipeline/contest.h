// Ways from points to heights that take turns on one cloud, and their times beside each other.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/pipeline/rasters.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::bench {

struct Contestant {
  std::string method;
  bool slow = false;  ///< takes part in few rounds
  std::function<scene::DepthGrid()> run;
};

struct ContestRow {
  std::string method;
  scene::DepthGrid grid;
  double seconds = 0.0;  ///< best round
  double ratio = 1.0;    ///< median over the rounds of this method's time over the first one's in the same round
  double ratio_low = 1.0, ratio_high = 1.0;  ///< least and greatest of these
  int rounds = 0;
};

/// Every round runs each contestant once, each round another one first; slow ones in the first `slow_rounds` only. The
/// first contestant is what ratios refer to and must not be slow.
[[nodiscard]] std::vector<ContestRow> contest(const std::vector<Contestant>& contestants, int rounds, int slow_rounds);

/// sparsha on one thread, the four rasters, and PCL's moving least squares (radius: three point spacings) before the
/// rasters `mean` and `z-buffer max`, all on the lattice that sparsha's configuration gives. `cloud` outlives the
/// result, `points` are those of the cloud.
[[nodiscard]] std::vector<Contestant> contestants_of(const pipeline::Cloud& cloud,
                                                     const std::vector<std::array<double, 3>>& points,
                                                     const scene::GridConfig& config, double resolution_m,
                                                     const scene::Lattice& lattice, double point_spacing_m);

}  // namespace sparsha::bench
