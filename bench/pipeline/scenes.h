// The accuracy scenes: simulated scans whose truth is known, each with the bounds it has to keep.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/simulate/simulate.h"

namespace sparsha::bench {

inline constexpr double kNoBound = std::numeric_limits<double>::infinity();

struct Scene {
  std::string name;
  pipeline::SimulationConfig config;
  // Bounds; millimetres and percent. Away: farther than three node spacings from a step; smooth: and from a crease.
  double rms_away_mm = kNoBound;
  double p99_away_mm = kNoBound;
  double off2_away_percent = kNoBound;
  double off5_all_percent = kNoBound;
  double rms_all_mm = kNoBound;
  double rms_smooth_mm = kNoBound;
  double least_coverage_percent = 0.0;
  double least_beside_percent = 0.0;  ///< nodes beside a bar that are right within 1 mm
};

/// `quick` leaves out the densest.
[[nodiscard]] std::vector<Scene> accuracy_scenes(bool quick);

}  // namespace sparsha::bench
