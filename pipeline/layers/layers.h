// What is computed on a depth grid: fill, texture, friction map and pyramid.
#pragma once

#include <vector>

#include "base/threads/progress.h"
#include "base/threads/thread_pool.h"
#include "scene/config/layers.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Fills unknown nodes inside the morphological closing of the measured ones by a disc of `max_gap_m`, never outside
/// the outline, not across a step higher than `step_m` (the lower side wins). Filled nodes are marked.
void fill_gaps(scene::DepthGrid& grid, const scene::FillConfig& config, double step_m, ThreadPool& pool);

/// Bilateral-filtered heights f_b (Tomasi & Manduchi 1998), NaN where unknown; texture is h = f - f_b.
[[nodiscard]] std::vector<float> bilateral_envelope(const scene::DepthGrid& grid, const scene::TextureConfig& config,
                                                    ThreadPool& pool);

/// The envelope that friction takes: that of bilateral_envelope(), and where unknown nodes or a step are within reach
/// the one that it would be if the node's own layer went on as the quadratic through it. `noise_m` and `step_m` as
/// below.
[[nodiscard]] std::vector<float> continued_envelope(const scene::DepthGrid& grid, const std::vector<float>& envelope_m,
                                                    const scene::TextureConfig& config, double noise_m, double step_m,
                                                    ThreadPool& pool);

/// Curvatures of the texture f - f_b by a Gaussian-weighted fit at `scale_m` over the nodes of a node's own layer, less
/// their noise expectation; NaN where the height is unknown and where too few nodes of the layer say anything.
/// `noise_m` is the heights' white noise per node (of points with n a node: their noise / sqrt(n)); a jump that the
/// surface continues on neither side is a step from about 0.9 spacings or 8 noises on, in any case from `step_m`;
/// `sigma_space_m` is the envelope's, which takes most of the noise along (0: it takes none).
struct CurvatureMap {
  std::vector<float> rms_per_m;        ///< k = sqrt(max(0, 2H^2 - K))
  std::vector<float> mean_per_m;       ///< H
  std::vector<float> gaussian_per_m2;  ///< K
  double percentile_95_per_m = 0.0;    ///< of k over measured nodes
  double noise_floor_per_m = 0.0;      ///< k that noise alone would give
};
[[nodiscard]] CurvatureMap texture_curvature(const scene::DepthGrid& grid, const std::vector<float>& envelope_m,
                                             double scale_m, double noise_m, double step_m, ThreadPool& pool,
                                             double sigma_space_m = 0.0);

/// Slope c of law: curvature, metres; see ALGORITHMS "Friction map".
[[nodiscard]] double friction_slope(const CurvatureMap& map, const scene::FrictionConfig& config);

/// Levels 1, 2, ... below `base` until the longer side has at most `window` nodes; fewer where the next would have no
/// cell with four known nodes, as that of a narrow strip or of scattered nodes. NaN-aware low-pass before halving.
[[nodiscard]] std::vector<scene::Layers> build_pyramid(const scene::Layers& base, int window, ThreadPool& pool);

}  // namespace sparsha::pipeline
