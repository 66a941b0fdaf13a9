#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "haptics/session/announcer.h"
#include "haptics/session/window_loader.h"
#include "tests/support/scenes.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

scene::SceneDescription description_of(int nx, int ny, int levels, int window) {
  scene::SceneDescription description;
  description.config.levels.window = window;
  double spacing_m = 0.001;
  for (int level = 0; level < levels; ++level) {
    scene::Lattice lattice;
    lattice.nx = nx;
    lattice.ny = ny;
    lattice.spacing_m = spacing_m;
    lattice.origin_m = {10.0, 20.0, 0.0};
    description.levels.push_back(lattice);
    nx = (nx + 1) / 2;
    ny = (ny + 1) / 2;
    spacing_m *= 2.0;
  }
  return description;
}

TEST(Window, TheOverviewIsTheFinestLevelThatFits) {
  EXPECT_EQ(overview_level(description_of(800, 600, 4, 200)), 2);
  EXPECT_EQ(overview_level(description_of(150, 120, 3, 200)), 0);
  EXPECT_EQ(overview_level(description_of(5000, 100, 2, 200)), 1) << "none fits: the coarsest";
}

TEST(Window, AWholeLevelKeepsItsOwnLatticeAndFillsTheWorkspace) {
  auto description = description_of(800, 600, 4, 200);
  // Beyond its rectangle, an outline, the window goes on until the surface has fallen 15 mm; the scale is the level's.
  const WindowPlan falls = plan_window(description, 2, {0.0, 0.0}, 0.1);
  EXPECT_GE(-falls.i0 * 0.0005, 0.008);
  EXPECT_EQ(falls.nx, 200 - 2 * falls.i0);
  EXPECT_EQ(falls.ny, 150 - 2 * falls.j0);
  EXPECT_NEAR(falls.scale, 0.1 / (199 * 0.004), 1e-12);
  description.config.haptics.beyond = scene::HapticsConfig::Beyond::continued;
  const WindowPlan plan = plan_window(description, 2, {0.0, 0.0}, 0.1);
  EXPECT_EQ(plan.i0, 0);
  EXPECT_EQ(plan.j0, 0);
  EXPECT_EQ(plan.nx, 200);
  EXPECT_EQ(plan.ny, 150);
  EXPECT_NEAR(plan.scale, 0.1 / (199 * 0.004), 1e-12);
}

TEST(Window, AWindowIsCentredOnThePointAndMayReachBeyondTheLevel) {
  const auto description = description_of(800, 600, 4, 200);
  const WindowPlan inside = plan_window(description, 0, {10.4, 20.3}, 0.1);
  EXPECT_EQ(inside.nx, 200);
  EXPECT_EQ(inside.ny, 200);
  EXPECT_LE(std::abs(inside.i0 + 99.5 - 400.0), 0.5);
  EXPECT_LE(std::abs(inside.j0 + 99.5 - 300.0), 0.5);
  EXPECT_NEAR(inside.scale, 0.1 / (199 * 0.001), 1e-9);
  EXPECT_LT(plan_window(description, 0, {10.0, 20.0}, 0.1).i0, -90);
}

TEST(Window, ZoomingGoesOnBeyondTheFinestLevelByWholePowersOfTwoUpToItsLimits) {
  constexpr double kWidth_m = 0.1;
  for (const double spacing_m : {0.00002, 0.0001, 0.0009, 0.001, 0.0037, 0.02}) {
    for (const int window : {200, 60}) {
      auto description = description_of(1600, 1200, 4, window);
      for (scene::Lattice& level : description.levels) level.spacing_m *= spacing_m / 0.001;
      const std::vector<ZoomStep> steps = zoom_steps(description, kWidth_m);
      ASSERT_GE(steps.size(), 1U);
      EXPECT_EQ(steps.front().level, overview_level(description));
      double before = 0.0;
      int near = 0;
      const double full = kWidth_m / ((window - 1) * spacing_m);
      for (const ZoomStep& step : steps) {
        const WindowPlan plan = plan_window(description, step, middle_of(description.levels.front()), kWidth_m);
        EXPECT_GT(plan.scale, 1.15 * before) << spacing_m;
        before = plan.scale;
        if (step.level > 0 || step.nodes == window) continue;
        ++near;
        const double power = std::log2(plan.scale);
        const bool last = near == static_cast<int>(steps.size()) - 1 - overview_level(description);
        if (!last) {
          EXPECT_NEAR(power, std::round(power), 0.06) << spacing_m << ", " << plan.scale;
        }
        EXPECT_LE(plan.scale, 8.0 * 1.03) << spacing_m;
        EXPECT_LE(plan.scale * spacing_m, 0.004 * 1.03) << spacing_m;
      }
      // The nearest view is at one of the limits, within a step that is not worth taking.
      const double limit = std::min(8.0, 0.004 / spacing_m);
      EXPECT_GE(before, std::max(limit / 1.25, full * 0.99)) << spacing_m;
      EXPECT_LE(before, std::max(limit * 1.03, full * 1.01)) << spacing_m;
    }
  }
}

TEST(Window, ANearWindowHoldsTheSameStoneInFewerNodes) {
  const auto scene = sparsha::test::scene_of(sparsha::test::hills_m, 401, 0.1, 101);
  const std::vector<ZoomStep> steps = zoom_steps(scene->description(), 0.1);
  ASSERT_GE(steps.size(), 3U);
  const Eigen::Vector2d centre_m = middle_of(scene->description().levels.front()) + Eigen::Vector2d(0.003, -0.002);
  const HapticWindow wide = load_window(*scene, plan_window(scene->description(), 0, centre_m, 0.1), 1);
  const HapticWindow near = load_window(*scene, plan_window(scene->description(), steps.back(), centre_m, 0.1), 2);
  EXPECT_LE(near.surface->lattice.nx, wide.surface->lattice.nx / 2 + 1);
  EXPECT_NEAR(near.surface->width_m() * near.surface->scale, 0.1, 1e-12);
  // The fingertip is smaller on the stone, and a point where it is off.
  auto sharp = plan_window(scene->description(), steps.back(), centre_m, 0.1);
  sharp.tip_radius_m = 0.0;
  const HapticWindow point = load_window(*scene, sharp, 3);
  const scene::Lattice& lattice = point.surface->lattice;
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i)
      EXPECT_NEAR(point.surface->height_m[lattice.index(i, j)] + lattice.origin_m.z(),
                  sparsha::test::hills_m(lattice.x_m(i), lattice.y_m(j)), 1e-6);
}

/// A scene that cannot be read, as when a disk goes away.
class BrokenScene final : public scene::Scene {
 public:
  explicit BrokenScene(scene::SceneDescription description) : description_(std::move(description)) {}
  [[nodiscard]] const scene::SceneDescription& description() const override { return description_; }
  [[nodiscard]] scene::Layers read(int, int, int, int, int) const override {
    throw std::runtime_error("the disk is gone");
  }
  [[nodiscard]] std::filesystem::path folder() const override { return {}; }

 private:
  scene::SceneDescription description_;
};

TEST(WindowLoader, HandsBackWhatWentWrongInsteadOfThrowing) {
  WindowLoader loader;
  WindowLoader::Job job;
  job.scene = std::make_shared<BrokenScene>(description_of(800, 600, 4, 200));
  job.plan = plan_window(job.scene->description(), 0, {10.4, 20.3}, 0.1);
  loader.request(std::move(job));
  for (;;)
    if (const auto result = loader.take()) {
      EXPECT_NE(result->error.find("the disk is gone"), std::string::npos);
      break;
    }
}

TEST(Window, LoadsFromASixteenThousandNodeSceneOnDiskReadingOnlyItsTiles) {
  const bool nightly = std::getenv("SPARSHA_NIGHTLY") != nullptr;
  const int nodes = nightly ? 16384 : 2048;
  const test::TestFolder folder;
  scene::write_scene(*sparsha::test::scene_of([](double x, double y) { return 0.01 * x * y; }, nodes, 1.0, 200,
                                              Eigen::Vector3d::Zero(),
                                              [](scene::SceneDescription& d) {
                                                scene::ScanConfig scan;
                                                scan.file = "none.ply";
                                                d.config.scans.push_back(scan);
                                              }),
                     folder);
  const auto scene = scene::open_scene(folder);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  std::vector<double> times;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d centre(place(random), place(random));
    const auto begun = std::chrono::steady_clock::now();
    WindowPlan plan = plan_window(scene->description(), 0, centre, 0.1);
    plan.tip_radius_m = i % 2 == 0 ? 0.0 : plan.tip_radius_m;
    const HapticWindow window = load_window(*scene, plan, 1);
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count());
    // The right nodes: float heights of a bilinear surface, exact in every cell but for rounding.
    const Eigen::Vector3d at = window.surface->centre_m - window.surface->lattice.origin_m;
    const Eigen::Vector2d middle = window.surface->centre_m.head<2>();
    if (plan.tip_radius_m == 0.0 && middle.minCoeff() > 0.1 && middle.maxCoeff() < 0.9) {
      EXPECT_NEAR(window.surface->height(at.x(), at.y()) + window.surface->lattice.origin_m.z(),
                  0.01 * middle.x() * middle.y(), 0.01 * 1e-7 * 2.0);
    }
  }
  std::sort(times.begin(), times.end());
  std::printf("window of 200 nodes from %d x %d on disk: median %.1f ms, most %.1f ms\n", nodes, nodes,
              times[times.size() / 2], times.back());
}

}  // namespace
}  // namespace sparsha::haptics
