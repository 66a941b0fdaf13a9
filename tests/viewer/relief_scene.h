// Analytic scenes for the viewer's tests.
#pragma once

#include "haptics/state/state.h"
#include "scene/scene_fwd.h"
#include "tests/support/scenes.h"

namespace sparsha::viewer::test {

using sparsha::test::scene_of;
using sparsha::test::SceneOptions;

/// A stone plate with a lotus medallion and a wavy border, good to look at; metres, 0.4 m wide.
[[nodiscard]] double lotus(double x_m, double y_m);

/// A hand that presses on (x, y) of the grid frame, window of level 0 centred on (cx, cy).
[[nodiscard]] haptics::State touching(const scene::Scene& scene, double x_m, double y_m, double z_m, double cx_m,
                                      double cy_m);

}  // namespace sparsha::viewer::test
