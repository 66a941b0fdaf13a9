// What stands beside a simulated scan: the truth and the configuration that builds it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

struct SimulatedFile {
  std::string name;  ///< with ending
  std::uint64_t points = 0, back = 0, outliers = 0;
};

/// True heights as a tiled float64 TIFF, absolute, grid frame, top row first. Throws Error{failure}.
void write_truth_tiff(const Truth& truth, const std::filesystem::path& file, const std::string& shown,
                      const Context& context);
[[nodiscard]] std::string truth_world_file(const Truth& truth);
[[nodiscard]] std::string truth_json(const SimulationConfig& config, const Truth& truth,
                                     const std::vector<SimulatedFile>& files);
/// The configuration of a scene with the truth's lattice.
[[nodiscard]] std::string build_yaml(const SimulationConfig& config, const Truth& truth,
                                     const std::vector<SimulatedFile>& files);

}  // namespace sparsha::pipeline
