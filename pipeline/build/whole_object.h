// The charts of a whole object as a configuration asks for them, of points or of a mesh, and their cross-check.
#pragma once

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/charts/charts.h"
#include "pipeline/check/charts_check.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {

/// How far points on the faces of a mesh lie apart that is seen from all sides, in spacings of its grid.
inline constexpr double kPlacesOfSpacing = 0.8;

/// Of a transform, in each direction.
[[nodiscard]] double scale_of(const Eigen::Matrix4d& scan_to_grid);

/// As make_charts(), with the attributes that `config` asks for; points that are too uneven are thinned, with a
/// warning. `grid` is its grid with what is known of it by now; a mesh is sampled as densely as `front_spacing_m`, the
/// spacing of the front view, asks for.
[[nodiscard]] ChartResult charts_of(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                                    const scene::GridConfig& grid, double front_spacing_m, const scene::Config& config,
                                    const Context& context);

/// Holds the points as measured, or others on a mesh than the charts were made of, against charts. Requires
/// config.check.
[[nodiscard]] ChartCheck check_charts_of(Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                                         const scene::Config& config, const Context& context);

}  // namespace sparsha::pipeline
