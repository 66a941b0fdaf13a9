// Analytic scenes for the viewer's tests.
#pragma once

#include <functional>

#include "haptics/shared/state.h"
#include "pipeline/scene/scene.h"

namespace sparsha::viewer::test {

struct SceneOptions {
  int nx = 256;
  int ny = 256;
  double spacing_m = 0.001;
  int levels = 1;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
};

/// Height in metres above the origin at x, y in metres from node (0, 0); NaN is unknown.
using Height = std::function<double(double x_m, double y_m)>;

/// Level L takes every 2^L-th node.
[[nodiscard]] pipeline::ScenePointer scene_of(const Height& height, const SceneOptions& options,
                                              const std::function<void(pipeline::SceneDescription&)>& edit = {},
                                              const std::function<void(pipeline::Layers&)>& edit_layers = {});

/// A stone plate with a lotus medallion and a wavy border, good to look at; metres, 0.4 m wide.
[[nodiscard]] double lotus(double x_m, double y_m);

/// A hand that presses on (x, y) of the grid frame, window of level 0 centred on (cx, cy).
[[nodiscard]] haptics::State touching(const pipeline::Scene& scene, double x_m, double y_m, double z_m, double cx_m,
                                      double cy_m);

}  // namespace sparsha::viewer::test
