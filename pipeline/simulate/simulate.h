// A terrestrial scanner over a known surface: several stations, occlusion, range noise, outliers, uneven density and a
// rough back; the truth goes beside the scan.
#pragma once

#include <filesystem>

#include "pipeline/base/progress.h"

namespace sparsha::pipeline {

/// Runs `sparsha simulate CONFIG --out DIR`: reads the simulation's YAML (docs/configuration.md) and writes one PLY a
/// station, the ground truth and a ready configuration into `out`. Seeded; the same input gives the same bytes.
void simulate(const std::filesystem::path& config, const std::filesystem::path& out, Progress& progress);

}  // namespace sparsha::pipeline
