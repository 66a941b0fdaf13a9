// Grids of unlikely shapes: whatever is built can be used by every command, on every level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/layers/layers.h"
#include "scene/scene.h"
#include "tests/support/grids.h"
#include "tests/support/test_folder.h"
#include "tests/support/whole_way.h"

namespace sparsha::pipeline {
namespace {

using testing::forget;
using testing::grid_of;
using testing::lattice_of;

enum class Holes : std::uint8_t { none, columns, chessboard, lower_half, but_one_cell };

bool is_hole(Holes holes, int i, int j, const scene::Lattice& lattice) {
  switch (holes) {
    case Holes::none:
      return false;
    case Holes::columns:
      return i % 3 == 2;
    case Holes::chessboard:
      return (i + j) % 2 == 1;
    case Holes::lower_half:
      return 2 * j < lattice.ny;
    case Holes::but_one_cell:
      return i > 1 || j > 1;
  }
  return false;
}

/// As a build makes it of these heights; a window has 16 nodes a side, so that there are levels.
scene::ScenePointer scene_of(int nx, int ny, Holes holes) {
  ThreadPool pool(1);
  scene::SceneDescription scene;
  scene.config.levels.window = 16;
  scene.config.scans.resize(1);
  scene.config.scans.front().file = "scan.ply";
  scene::Layers base;
  base.grid = grid_of(lattice_of(nx, ny, 0.001), [](double x, double y) { return 1e-3 * std::sin(300 * x + 200 * y); });
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      if (is_hole(holes, i, j, base.grid.lattice)) forget(base.grid, i, j);
  scene.height_min_m = -1e-3;
  scene.height_max_m = 1e-3;
  std::vector<scene::Layers> levels = build_pyramid(base, scene.config.levels.window, pool);
  levels.insert(levels.begin(), std::move(base));
  for (const scene::Layers& level : levels) scene.levels.push_back(level.grid.lattice);
  return scene::make_scene(std::move(scene), std::move(levels));
}

void use(const test::TestFolder& folder, int nx, int ny, Holes holes) {
  SCOPED_TRACE(::testing::Message() << nx << " x " << ny << ", holes " << static_cast<int>(holes));
  EXPECT_NO_THROW(test::use_scene(scene_of(nx, ny, holes), folder));
}

TEST(Shapes, StripsOfAnyLengthCanBeUsedByEveryCommandOnEveryLevel) {
  const test::TestFolder folder;
  for (const int across : {2, 3, 4, 5})
    for (const int along : {2, 3, 15, 16, 17, 33, 64, 65, 450, 513}) {
      use(folder, across, along, Holes::none);
      use(folder, along, across, Holes::none);
    }
  use(folder, 2, 5000, Holes::none);
  use(folder, 5000, 3, Holes::none);
}

TEST(Shapes, SidesAboutPowersOfTwoCanBeUsedByEveryCommandOnEveryLevel) {
  const test::TestFolder folder;
  for (const int side : {16, 32, 64})
    for (const int more : {-1, 0, 1}) use(folder, side + more, side - more, Holes::none);
}

TEST(Shapes, GridsWhoseCoarserLevelsWouldHaveNoKnownCellCanBeUsedByEveryCommand) {
  const test::TestFolder folder;
  for (const Holes holes : {Holes::columns, Holes::chessboard, Holes::lower_half, Holes::but_one_cell})
    for (const auto& [nx, ny] : {std::pair{2, 2}, {5, 450}, {3, 40}, {33, 33}, {64, 17}}) use(folder, nx, ny, holes);
}

}  // namespace
}  // namespace sparsha::pipeline
