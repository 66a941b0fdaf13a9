// Whole objects whose surface is known, as charts and as scenes with a view of their front.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "pipeline/charts/charts.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"
#include "tests/support/scenes.h"

namespace sparsha::viewer::test {

/// Charts of a scan of so many points; `noise` in point spacings.
inline scene::Charts charts_of(const sparsha::test::ClosedObject& object, std::size_t points, double noise) {
  sparsha::test::ScanOptions options;
  options.points = points;
  options.noise_spacings = noise;
  options.seed = 5;
  const sparsha::test::ObjectScan scan = sparsha::test::scan_object(object, options);
  ThreadPool pool(2);
  Progress progress;
  scene::GridConfig grid;
  grid.spacing_m = scan.spacing_m;
  return pipeline::make_charts(sparsha::test::make_cloud(scan.points), Eigen::Matrix4d::Identity(), grid, 0.0,
                               {pool, progress})
      .charts;
}

/// With the heights of the object's front as the only view.
inline scene::ScenePointer whole_scene(const sparsha::test::ObjectPtr& object, scene::Charts charts) {
  sparsha::test::SceneOptions options;
  options.nx = options.ny = 121;
  options.spacing_m = 0.025;
  options.origin_m = {-1.5, -1.5, 0.0};
  const auto height = [&](double x, double y) {
    return object->front_m(x - 1.5, y - 1.5).value_or(std::numeric_limits<double>::quiet_NaN());
  };
  return sparsha::test::scene_of(height, options, [&](scene::SceneDescription& description) {
    description.charts = std::make_shared<const scene::Charts>(std::move(charts));
  });
}

}  // namespace sparsha::viewer::test
