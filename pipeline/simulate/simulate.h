// A terrestrial scanner over a known surface: several stations, occlusion, range noise, outliers, uneven density and a
// rough back; the truth goes beside the scan. docs/measure/simulation.md describes the YAML.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "pipeline/simulate/surface.h"
#include "scene/config/orientation.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Points drawn on the surface as an orthographic camera sees it: uniform at random over the plane, noise along z.
struct SamplerConfig {
  double points_per_node = 3.6;  ///< front points, outliers included, per cell of the truth's lattice
  double density_ratio = 1.0;    ///< density at x = width over density at x = 0; varies exponentially
  int files = 1;                 ///< equal shares of the points, the whole surface in each
};
/// One scanner set-up, in the local frame of the surface.
struct StationConfig {
  std::string name;  ///< file name without ending; station-N when empty
  Eigen::Vector3d position_m{0.5, 0.5, 2.0};
  Eigen::Vector3d target_m{0.5, 0.5, 0.0};  ///< centre of its field of view
  double step_rad = 0.001;                  ///< between beams, in both directions
};
struct ScannerConfig {
  std::vector<StationConfig> stations;
};

struct SimulationConfig {
  std::uint64_t seed = 1;
  SurfaceConfig surface;
  std::variant<SamplerConfig, ScannerConfig> scan = SamplerConfig{};
  int nodes = 512;                 ///< along the longer side of the truth's lattice
  double noise_m = 0.0002;         ///< standard deviation along the beam
  double outlier_fraction = 0.0;   ///< of the points, displaced along the beam
  double outlier_spread_m = 0.05;  ///< by at most this much either way, uniform
  /// Scan frame: the local origin lies at `origin_m`, local z looks to `look_from`, local y goes up.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d look_from{0, 0, 1};
  Eigen::Vector3d up{0, 1, 0};
  bool double_precision = false;  ///< PLY coordinates
  bool intensity = false;         ///< PLY: float intensity, 0 to 1
  bool colour = false;            ///< PLY: red green blue
  bool write_truth = true;        ///< truth.tif; 8 bytes per node
  bool station_frame = false;     ///< files in the stations' own frames, poses in the configuration
};

/// Reads a simulation's YAML. Throws Error{usage} with line, column and the nearest valid key.
[[nodiscard]] SimulationConfig parse_simulation(const yaml::Node& root);

struct SimulatedPoint {
  Eigen::Vector3d position_m;  ///< scan frame, double
  float intensity = 0.0F;
  std::uint32_t rgba = 0;  ///< 0xAABBGGRR
  bool is_front = true;    ///< false: on the back
  bool is_outlier = false;
};

/// A scan in memory, one entry per point.
struct SimulatedScan {
  std::vector<Eigen::Vector3d> points_m;  ///< scan frame
  std::vector<std::uint8_t> is_front;
  std::vector<std::uint8_t> is_outlier;
  std::vector<std::uint32_t> station;  ///< index of the file
  std::vector<std::uint32_t> rgba;     ///< 0xAABBGGRR
  std::vector<float> intensity;
};

/// The truth in the grid frame, grid = scan_to_grid() * scan, to compare a depth grid with.
class Truth {
 public:
  explicit Truth(const SimulationConfig& config);

  [[nodiscard]] const Surface& surface() const { return surface_; }
  /// The orientation block's matrix: rotation only.
  [[nodiscard]] const Eigen::Matrix4d& scan_to_grid() const { return scan_to_grid_; }
  /// Lattice of the truth, grid frame; what `grid: {spacing_mm, bounds_m: bounds_m()}` gives.
  [[nodiscard]] const scene::Lattice& lattice() const { return lattice_; }
  [[nodiscard]] std::array<double, 4> bounds_m() const;
  /// True height at (x, y), grid frame, metres.
  [[nodiscard]] double height_m(double x, double y) const;
  /// As the Surface's, grid frame.
  [[nodiscard]] double step_distance_m(double x, double y) const;
  [[nodiscard]] double crease_distance_m(double x, double y) const;

 private:
  Surface surface_;
  Eigen::Matrix4d scan_to_grid_;
  Eigen::Vector3d grid_origin_m_;
  scene::Lattice lattice_;
};

/// Calls `sink` with the points of file `index` in the file's order, block by block; memory stays below some MB.
using SimulatedPointSink = std::function<void(std::span<const SimulatedPoint>)>;
void generate_file(const SimulationConfig& config, const Surface& surface, std::size_t index, const Context& context,
                   const SimulatedPointSink& sink);
[[nodiscard]] std::size_t file_count(const SimulationConfig& config);

/// All points in memory. The same configuration gives the same bits whatever the pool.
[[nodiscard]] SimulatedScan generate(const SimulationConfig& config, ThreadPool& pool);
[[nodiscard]] SimulatedScan generate(const SimulationConfig& config);

/// Writes into the folder `out` one binary PLY a file, truth.tif (float64 heights), truth.json and sparsha.yaml, the
/// configuration that builds it. Seeded; the same input gives the same bytes. Each file appears whole or not at all.
/// Throws Error{usage, failure}; Cancelled.
void write_simulation(const SimulationConfig& config, const std::filesystem::path& out, Progress& progress);

/// Runs `sparsha simulate CONFIG --out DIR`.
void simulate(const std::filesystem::path& config, const std::filesystem::path& out, Progress& progress);

}  // namespace sparsha::pipeline
