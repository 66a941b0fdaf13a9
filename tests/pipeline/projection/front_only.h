// Clouds of closed objects, projected and judged by the bounds that are asked of their front.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/closed_bounds.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::test {

inline constexpr std::size_t kFew = 20'000, kMany = 100'000;

/// torus, two spheres, the vase from the side and from above, the knot, the coin.
inline const std::vector<NamedObject>& objects() {
  static const std::vector<NamedObject> all = analytic_objects();
  return all;
}

inline ScanOptions cloud_of(std::size_t points, double noise = 0.1) {
  ScanOptions options;
  options.points = points;
  options.noise_spacings = noise;
  options.seed = 11;
  return options;
}

inline pipeline::Projection project_scan(const ObjectScan& scan, double grid_spacings = 1.0) {
  scene::GridConfig grid;
  grid.spacing_m = grid_spacings * scan.spacing_m;
  return project_cloud(make_cloud(scan.points), grid);
}

/// All of an object's bounds on one cloud; its median error may be `median` where there is a bound.
inline void expect_front_only(const NamedObject& named, const ScanOptions& options, double grid_spacings = 1.0,
                              double median = 0.05) {
  const ObjectScan scan = scan_object(*named.object, options);
  const pipeline::Projection p = project_scan(scan, grid_spacings);
  const Judgement f = judge_object(p.grid, *named.object, scan);
  const ClosedBounds bounds = closed_bounds(named.name, options);
  const std::string what = named.name + ", " + std::to_string(options.points) + " points, noise " +
                           std::to_string(options.noise_spacings) + ", grid " + std::to_string(grid_spacings);
  EXPECT_LE(f.wrong_smooth, bounds.wrong_smooth) << what;
  EXPECT_LE(f.beyond, bounds.beyond) << what;
  // All but a node or two along the silhouette, or what lies beyond the last line.
  EXPECT_GE(f.covered, options.points < kMany ? 0.85 : options.lines > 0.0 ? 0.89 : 0.92) << what;
  EXPECT_LE(f.median_spacings, median / 0.05 * bounds.median_spacings) << what;
}

inline double noise_ratio(const ObjectScan& scan, const Eigen::Matrix4d& view = Eigen::Matrix4d::Identity()) {
  scene::GridConfig grid;
  grid.spacing_m = scan.spacing_m;
  return project_cloud(make_cloud(scan.points), grid, view).noise_m / scan.noise_m;
}

/// The meshes of SPARSHA_SCANS_DIR; none where it is not set.
inline std::vector<NamedObject> real_meshes() {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  return mesh_objects(folder == nullptr ? "" : folder);
}

}  // namespace sparsha::test
