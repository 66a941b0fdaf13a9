// The front of closed objects over the whole range of densities, noises and grids: asked for by SPARSHA_NIGHTLY=1.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/closed_bounds.h"
#include "tests/support/closed_scan.h"
#include "tests/support/clouds.h"

namespace sparsha::test {
namespace {

using Cell = std::tuple<std::size_t, double, double>;  // points, noise and grid in mean point spacings

class ClosedObjectsMatrix : public ::testing::TestWithParam<Cell> {};

TEST_P(ClosedObjectsMatrix, ShowTheirFrontAndOnlyTheirFront) {
  if (std::getenv("SPARSHA_NIGHTLY") == nullptr) GTEST_SKIP() << "asked for by SPARSHA_NIGHTLY=1";
  const auto& [points, noise, grid_spacings] = GetParam();
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  std::vector<NamedObject> objects = analytic_objects();
  for (NamedObject& mesh : mesh_objects(folder == nullptr ? "" : folder)) objects.push_back(std::move(mesh));
  for (const NamedObject& named : objects) {
    ScanOptions options;
    options.points = points;
    options.noise_spacings = noise;
    options.seed = 11;
    const ObjectScan scan = scan_object(*named.object, options);
    scene::GridConfig grid;
    grid.spacing_m = grid_spacings * scan.spacing_m;
    const pipeline::Projection p = project_cloud(make_cloud(scan.points), grid);
    const Judgement f = judge_object(p.grid, *named.object, scan);
    const ClosedBounds bounds = closed_bounds(named.name, options);
    EXPECT_LE(f.wrong_smooth, bounds.wrong_smooth) << named.name;
    EXPECT_LE(f.wrong, bounds.wrong) << named.name;
    EXPECT_LE(f.beyond, bounds.beyond) << named.name;
    EXPECT_LE(f.median_spacings, bounds.median_spacings) << named.name;
    if (bounds.noise) {
      EXPECT_NEAR(p.noise_m / scan.noise_m, 1.0, 0.25) << named.name;
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<Cell>& cell) {
  const auto& [points, noise, grid_spacings] = cell.param;
  const auto percent = [](double share) { return std::to_string(static_cast<int>(100.0 * share + 0.5)); };
  return std::to_string(points) + "PointsNoise" + percent(noise) + "Grid" + percent(grid_spacings);
}

INSTANTIATE_TEST_SUITE_P(Nightly, ClosedObjectsMatrix,
                         ::testing::Combine(::testing::Values<std::size_t>(20'000, 100'000, 400'000),
                                            ::testing::Values(0.02, 0.1, 0.3, 0.5), ::testing::Values(1.0, 2.0, 0.5)),
                         name_of);

}  // namespace
}  // namespace sparsha::test
