// Whole objects of known surfaces as charts and scenes in memory, without any scan.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "scene/charts.h"
#include "scene/scene.h"
#include "tests/support/scenes.h"

namespace sparsha::test {

/// Height and slopes of a surface over (u, v) as a side sees it; nothing where the side does not.
struct SeenSurface {
  double w = 0.0, slope_u = 0.0, slope_v = 0.0;
};
using SeenFrom = std::function<std::optional<SeenSurface>(scene::Side side, double u, double v)>;

/// One sheet a side, over the square of `half` nodes to either side of the origin. `leave_out`: no sheet of that side.
inline scene::Charts charts_of(const SeenFrom& seen, int half, double spacing_m,
                               std::optional<scene::Side> leave_out = {}) {
  scene::Charts charts;
  charts.spacing_m = spacing_m;
  for (std::size_t k = 0; k < scene::kSides; ++k) {
    const auto side = static_cast<scene::Side>(k);
    if (side == leave_out) continue;
    scene::Sheet sheet;
    sheet.side = side;
    sheet.first_u = sheet.first_v = -half;
    sheet.nx = sheet.ny = 2 * half + 1;
    sheet.height_m.assign(sheet.count(), std::nanf(""));
    sheet.slope_u = sheet.slope_v = sheet.height_m;
    sheet.mask.assign(sheet.count(), 0);
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const auto here = seen(side, (i - half) * spacing_m, (j - half) * spacing_m);
        if (!here) continue;
        const std::size_t node = sheet.index(i, j);
        sheet.height_m[node] = static_cast<float>(here->w);
        sheet.slope_u[node] = static_cast<float>(here->slope_u);
        sheet.slope_v[node] = static_cast<float>(here->slope_v);
        sheet.mask[node] = scene::Sheet::kMeasured;
      }
    for (int j = 0; j + 1 < sheet.ny; ++j)
      for (int i = 0; i + 1 < sheet.nx; ++i)
        if (sheet.measured(sheet.index(i, j)) && sheet.measured(sheet.index(i + 1, j)) &&
            sheet.measured(sheet.index(i, j + 1)) && sheet.measured(sheet.index(i + 1, j + 1)))
          sheet.mask[sheet.index(i, j)] |= scene::Sheet::kCell;
    charts.sheets.push_back(std::move(sheet));
  }
  return charts;
}

/// A ball about the origin, up to a facing of 0.4 on each side.
inline scene::Charts ball_charts(double radius_m = 0.04, double spacing_m = 0.001,
                                 std::optional<scene::Side> leave_out = {}) {
  const auto seen = [radius_m](scene::Side, double u, double v) -> std::optional<SeenSurface> {
    const double w = std::sqrt(std::max(0.0, radius_m * radius_m - u * u - v * v));
    if (w < 0.4 * radius_m) return std::nullopt;
    return SeenSurface{w, -u / w, -v / w};
  };
  return charts_of(seen, static_cast<int>(radius_m / spacing_m) + 2, spacing_m, leave_out);
}

/// A cube about the origin with faces along the axes.
inline scene::Charts cube_charts(int half_nodes = 30, double spacing_m = 0.001) {
  const double half_m = half_nodes * spacing_m;
  return charts_of(
      [half_m](scene::Side, double, double) {
        return SeenSurface{half_m, 0.0, 0.0};
      },
      half_nodes, spacing_m);
}

/// A scene whose front view is level and as wide as the charts' box, so that the scale is that of a workspace of 0.1 m
/// over that width. `edit` changes its description.
inline scene::ScenePointer whole_scene(scene::Charts charts, double width_m = 0.1, const EditDescription& edit = {}) {
  auto kept = std::make_shared<const scene::Charts>(std::move(charts));
  const Eigen::Vector3d origin_m(-0.5 * width_m, -0.5 * width_m, 0.0);
  return scene_of([](double, double) { return 0.0; }, 201, width_m, 101, origin_m,
                  [kept, edit](scene::SceneDescription& d) {
                    d.charts = kept;
                    if (edit) edit(d);
                  });
}

}  // namespace sparsha::test
