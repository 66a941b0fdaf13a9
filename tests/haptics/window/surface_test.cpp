#include "haptics/window/surface.h"
#include "haptics/surface/monge_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"
#include "scene/scene.h"

namespace sparsha::haptics::test {
namespace {

using scene::FrictionConfig;
using scene::NodeState;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Window {
  scene::SceneDescription scene;
  scene::Layers layers;
};

/// A whole level of nx x ny measured nodes of height 0.
Window flat_window(int nx, int ny, double spacing_m) {
  Window window;
  scene::Lattice lattice;
  lattice.nx = nx;
  lattice.ny = ny;
  lattice.spacing_m = spacing_m;
  lattice.origin_m = {3.0, -2.0, 7.0};
  window.scene.levels = {lattice};
  window.layers.grid = scene::DepthGrid(lattice);
  std::fill(window.layers.grid.height_m.begin(), window.layers.grid.height_m.end(), 0.0F);
  std::fill(window.layers.grid.state.begin(), window.layers.grid.state.end(), NodeState::measured);
  return window;
}

void forget(Window& window, int i, int j) {
  const std::size_t node = window.layers.grid.lattice.index(i, j);
  window.layers.grid.height_m[node] = kNan;
  window.layers.grid.state[node] = NodeState::unknown;
}

}  // namespace

TEST(MongeSurface, IsBilinearInsideCellsAndLevelBeyondTheBorder) {
  Window window = flat_window(3, 2, 0.5);
  window.layers.grid.height_m = {0, 1, 2, 4, 3, 8};
  const auto surface = make_surface(window.scene, window.layers, 0, 2.0, {});
  EXPECT_DOUBLE_EQ(surface->height(0.25, 0.25), 0.25 * (0 + 1 + 4 + 3));
  EXPECT_DOUBLE_EQ(surface->height(1.0, 0.5), 8.0);
  EXPECT_DOUBLE_EQ(surface->height(5.0, -3.0), 2.0);
  EXPECT_DOUBLE_EQ(surface->width_m(), 1.0);
  EXPECT_DOUBLE_EQ(surface->highest_m, 8.0);
  EXPECT_EQ(surface->centre_m, Eigen::Vector3d(3.5, -1.75, 7.0 + 0.25 * (1 + 1 + 3 + 3)));
  EXPECT_DOUBLE_EQ(surface->scale, 2.0);
}

TEST(MongeSurface, HasNoHeightAtAPlaceThatIsNoNumber) {
  Window window = flat_window(3, 2, 0.5);
  const auto surface = make_surface(window.scene, window.layers, 0, 1.0, {});
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(surface->height(kNone, 0.25)));
  EXPECT_TRUE(std::isnan(surface->height(0.25, kNone)));
  EXPECT_EQ(surface->height(std::numeric_limits<double>::infinity(), 0.25), 0.0);
}

TEST(MongeSurface, FlagsCellsByTheirNodes) {
  Window window = flat_window(5, 4, 1.0);
  forget(window, 1, 1);
  window.layers.grid.state[window.layers.grid.lattice.index(4, 3)] = NodeState::filled;
  const auto whole = make_surface(window.scene, window.layers, 0, 1.0, {});
  EXPECT_EQ(whole->cell_flags[0], kCellUnknown);
  EXPECT_EQ(whole->cell_flags[1 * 4 + 1], kCellUnknown);
  EXPECT_EQ(whole->cell_flags[2 * 4 + 3], kCellFilled);
  EXPECT_EQ(whole->cell_flags[2 * 4 + 1], 0);

  // The same window of a level that begins one node to its right.
  window.scene.levels[0].origin_m.x() += 1.0;
  const auto shifted = make_surface(window.scene, window.layers, 0, 1.0, {});
  EXPECT_EQ(shifted->cell_flags[0], kCellOutside | kCellUnknown);
  EXPECT_EQ(shifted->cell_flags[2 * 4 + 0], kCellOutside);
  EXPECT_EQ(shifted->cell_flags[2 * 4 + 1], 0);
}

TEST(MongeSurface, RendersTheEnvelopeWithoutTexture) {
  Window window = flat_window(3, 3, 1.0);
  window.layers.envelope_m.assign(9, 0.5F);
  SurfaceOptions options;
  EXPECT_EQ(make_surface(window.scene, window.layers, 0, 1.0, options)->height(1.0, 1.0), 0.0);
  options.effects.texture = false;
  EXPECT_EQ(make_surface(window.scene, window.layers, 0, 1.0, options)->height(1.0, 1.0), 0.5);
}

TEST(MongeSurface, RefusesLayersThatDoNotMatch) {
  Window window = flat_window(3, 3, 1.0);
  window.layers.curvature_per_m.assign(4, 1.0F);
  EXPECT_THROW((void)make_surface(window.scene, window.layers, 0, 1.0, {}), Error);
  EXPECT_THROW((void)make_surface(flat_window(3, 3, 1.0).scene, flat_window(3, 3, 1.0).layers, 1, 1.0, {}), Error);
  EXPECT_THROW((void)make_surface(flat_window(3, 3, 1.0).scene, flat_window(3, 3, 1.0).layers, 0, 0.0, {}), Error);
}

TEST(Friction, OfLawCurvatureGrowsWithTheCurvatureOfLevelZeroWhateverTheZoom) {
  Window window = flat_window(4, 4, 0.01);
  window.scene.config.friction = FrictionConfig{};
  window.scene.friction_c_m = 0.002;
  window.layers.curvature_per_m = std::vector<float>(16, 100.0F);
  window.layers.curvature_per_m[5] = 1000.0F;  // beyond mu_max
  window.layers.curvature_per_m[6] = kNan;     // near a step
  forget(window, 3, 3);
  for (const double scale : {0.1, 1.0, 40.0}) {
    const auto surface = make_surface(window.scene, window.layers, 0, scale, {});
    EXPECT_FLOAT_EQ(surface->mu_dynamic[0], 0.4F);
    EXPECT_FLOAT_EQ(surface->mu_dynamic[5], 0.9F);
    EXPECT_FLOAT_EQ(surface->mu_static[5], 0.9F) << "mu_s is at least mu_d";
    EXPECT_FLOAT_EQ(surface->mu_dynamic[6], 0.2F);
    EXPECT_FLOAT_EQ(surface->mu_static[6], 0.4F);
    EXPECT_EQ(surface->mu_dynamic[15], 0.0F) << "unknown nodes are frictionless";
    EXPECT_EQ(surface->mu_static[15], 0.0F);
  }
}

TEST(Friction, OfLawPaperIsItsFormulaWithTheClampsInUprightAndLyingWindows) {
  for (const bool upright : {false, true}) {
    Window window = upright ? flat_window(5, 6, 0.02) : flat_window(6, 5, 0.02);
    FrictionConfig config;
    config.law = FrictionConfig::Law::paper;
    config.mu_max = 0.8;
    config.mu_static = 0.1;
    window.scene.config.friction = config;
    window.layers.mean_curvature_per_m.assign(30, 0.0F);
    window.layers.gaussian_curvature_per_m2.assign(30, 0.0F);
    window.layers.mean_curvature_per_m[7] = 30.0F;
    window.layers.gaussian_curvature_per_m2[7] = -400.0F;
    const double scale = 2.0;
    const auto surface = make_surface(window.scene, window.layers, 0, scale, {});
    // Lengths grow by the scale, curvatures shrink; R is half of 5 * 0.02 m * 2.
    const double expected = 1.0 / (0.1 * std::sqrt(15.0 * 15.0 + 100.0 * 100.0));
    EXPECT_FLOAT_EQ(surface->mu_dynamic[7], static_cast<float>(expected));
    EXPECT_FLOAT_EQ(surface->mu_static[7], 0.1F);
    EXPECT_FLOAT_EQ(surface->mu_dynamic[0], 0.8F) << "flat texture has no finite coefficient";
  }
}

TEST(Friction, OfLawConstantIsTheSameEverywhereAndCanBeTurnedOff) {
  Window window = flat_window(3, 3, 1.0);
  FrictionConfig config;
  config.law = FrictionConfig::Law::constant;
  config.mu_0 = 0.35;
  config.mu_static = 0.3;
  window.scene.config.friction = config;
  SurfaceOptions options;
  const auto rough = make_surface(window.scene, window.layers, 0, 1.0, options);
  EXPECT_EQ(rough->mu_dynamic, std::vector<float>(9, 0.35F));
  EXPECT_EQ(rough->mu_static, std::vector<float>(9, 0.35F));
  options.effects.friction = false;
  EXPECT_TRUE(make_surface(window.scene, window.layers, 0, 1.0, options)->mu_dynamic.empty());
}

}  // namespace sparsha::haptics::test
