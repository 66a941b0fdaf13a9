// Heights against the truth.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pipeline/simulate/simulate.h"
#include "scene/depth_grid.h"

namespace sparsha::bench {

/// One height a method gives, grid frame.
struct Sample {
  double x_m, y_m, z_m;
};

struct Figures {
  double coverage_percent = 0.0;  ///< samples / nodes of the truth's lattice
  double rms_away_mm = 0.0, p99_away_mm = 0.0, off2_away_percent = 0.0;
  double rms_all_mm = 0.0, off5_all_percent = 0.0;
  double rms_smooth_mm = 0.0;
  double median_mm = 0.0;
  double beside_percent = 0.0;  ///< bars: nodes beside one that are right within 1 mm
};

/// Measured nodes only. Throws Error{failure} when the lattice is not the truth's.
[[nodiscard]] std::vector<Sample> samples_of(const scene::DepthGrid& grid, const pipeline::Truth& truth);
[[nodiscard]] Figures judge(std::span<const Sample> samples, const pipeline::Truth& truth);

}  // namespace sparsha::bench
