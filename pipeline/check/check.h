// The cross-check of a depth grid against the raw points: their distances to the surface, and by FLANN's kd-tree
// through PCL those of its nodes to the points.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/threads/context.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/layers.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Unsigned Euclidean distances; all empty when nothing was sampled. `signed_mean_m` stands beside.
struct DistanceStatistics {
  std::uint64_t samples = 0;
  double mean_m = 0, rms_m = 0, median_m = 0, mad_m = 0, p95_m = 0, p99_m = 0, max_m = 0;
  double signed_mean_m = 0;
  double mean_ci95_m = 0;  ///< half width of the mean's 95 % confidence interval; 0 when every point was taken
};

/// Mean distance of the sampled points that lie nearest to a node, of the nodes that have any: memory for the sample,
/// not for the lattice.
struct NodeErrors {
  std::vector<std::uint64_t> node;  ///< ascending
  std::vector<float> error_m;       ///< of each of them
};

struct CheckResult {
  /// What the surface was held against.
  enum class Against : std::uint8_t { points, mesh, mesh_and_points };
  Against against = Against::points;
  /// Each point that is not occluded, outside or invalid, to the bilinear surface. Of a mesh its corners do not count,
  /// but places spread evenly over what the view shows of its triangles.
  DistanceStatistics cloud_to_surface;
  DistanceStatistics surface_to_cloud;  ///< each measured node to its nearest point, be it one of a triangle
  std::optional<double> completeness;
  double tolerance_m = 0.0;  ///< max(spacing, 3 min(noise, point spacing / 2))
  NodeErrors node_errors;
  std::vector<std::uint64_t> cloud_histogram;  ///< 64 equal bins up to p99 * 1.5; what lies beyond is not counted
  double histogram_bin_m = 0.0;
  std::vector<std::uint64_t> surface_histogram;  ///< of surface_to_cloud, in bins of surface_histogram_bin_m
  double surface_histogram_bin_m = 0.0;
  /// Points whose distance a second method, which walks the lattice and knows no tree, found too, and the largest
  /// disagreement.
  std::uint64_t second_method_samples = 0;
  double second_method_max_difference_m = 0.0;
};

/// As messages call it: "the points", "the mesh", "the mesh and the points".
[[nodiscard]] const char* words_of(CheckResult::Against against);
/// "half of the points lie", "half of the mesh lies", ...
[[nodiscard]] std::string half_of(CheckResult::Against against);

/// The points that count, wherever they lie: x y z of one after the other, metres relative to the lattice's origin.
/// Spans are good during the call only; the order of points does not matter.
struct CountedPoints {
  using Use = std::function<void(std::span<const float> xyz)>;

  std::uint64_t size = 0;
  std::function<void(const Use&)> each;  ///< hands over all of them, piece by piece
  /// Hands over those between two rows of nodes, and perhaps others. Called by several threads at once.
  std::function<void(double first_row, double last_row, const Use&)> in_rows;
};

/// `noise_m` and `point_spacing_m` are the projection's.
[[nodiscard]] CheckResult cross_check(const CountedPoints& points, const scene::DepthGrid& grid, double noise_m,
                                      double point_spacing_m, const std::optional<scene::FillConfig>& fill,
                                      const scene::CheckConfig& config, const Context& context);

/// `projection` says which points count; where the cloud has faces they are a mesh, see SeenMesh. Scene frame: grid =
/// scan_to_grid * scan.
[[nodiscard]] CheckResult cross_check(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                                      const Projection& projection, const std::optional<scene::FillConfig>& fill,
                                      const scene::CheckConfig& config, const Context& context);

}  // namespace sparsha::pipeline
