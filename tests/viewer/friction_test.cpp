// What the hand feels, the viewer shows and the report prints of a scene's friction is one value at every node.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/text/text.h"
#include "haptics/surface/monge_surface.h"
#include "haptics/window/surface.h"
#include "pipeline/report/images.h"
#include "relief_scene.h"
#include "scene/scene.h"
#include "viewer/surface/paint.h"

namespace sparsha::viewer::test {
namespace {

using scene::FrictionConfig;

constexpr int kNodes = 120;
constexpr double kSpacing_m = 0.0005;
constexpr double kFrictionCM = 0.002;

struct Case {
  const char* name;
  FrictionConfig::Law law;
  int window;   // levels.window
  bool layers;  // curvature layers are there
  double workspace_m = 0.1;
};

/// The law as the papers and docs/configuration.md write it, one node.
double written_law(const FrictionConfig& config, const scene::Layers& layers, std::size_t k, double scale,
                   double workspace_m) {
  const double radius_m = 0.5 * workspace_m;
  double mu = config.mu_0;
  if (config.law == FrictionConfig::Law::curvature && !layers.curvature_per_m.empty()) {
    const auto curvature = static_cast<double>(layers.curvature_per_m[k]);
    if (!std::isnan(curvature)) mu = config.mu_0 + kFrictionCM * curvature;
  }
  if (config.law == FrictionConfig::Law::paper && !layers.mean_curvature_per_m.empty()) {
    const double h = static_cast<double>(layers.mean_curvature_per_m[k]) / scale;
    const double g = static_cast<double>(layers.gaussian_curvature_per_m2[k]) / scale / scale;
    if (!std::isnan(h)) mu = 1.0 / radius_m / std::sqrt(h * h + g * g);
  }
  return std::min(std::max(mu, 0.0), config.mu_max);
}

TEST(Friction, IsTheSameFeltShownAndReportedUnderEveryLaw) {
  for (const Case& c : {Case{"curvature", FrictionConfig::Law::curvature, 400, true},
                        Case{"curvature without its layer", FrictionConfig::Law::curvature, 400, false},
                        Case{"paper", FrictionConfig::Law::paper, 400, true},
                        Case{"paper in a Falcon's workspace", FrictionConfig::Law::paper, 400, true, 0.07},
                        Case{"paper in a window smaller than the level", FrictionConfig::Law::paper, 40, true},
                        Case{"paper without its layers", FrictionConfig::Law::paper, 40, false},
                        Case{"constant", FrictionConfig::Law::constant, 400, true}}) {
    SCOPED_TRACE(c.name);
    SceneOptions options;
    options.nx = kNodes;
    options.ny = kNodes / 2;
    options.spacing_m = kSpacing_m;
    const auto scene =
        scene_of([](double x, double y) { return 0.0005 * std::sin(300.0 * x) * std::cos(200.0 * y); }, options,
                 [&](scene::SceneDescription& description) {
                   description.config.friction = FrictionConfig{};
                   description.config.friction->law = c.law;
                   description.config.levels.window = c.window;
                   description.friction_c_m = kFrictionCM;
                   description.has_curvature = description.has_paper_curvatures = c.layers;
                 },
                 [&](scene::Layers& layers) {
                   if (!c.layers) return;
                   const std::size_t count = layers.grid.lattice.count();
                   for (std::size_t k = 0; k < count; ++k) {
                     const auto wave = static_cast<float>(std::sin(0.37 * static_cast<double>(k)));
                     layers.curvature_per_m.push_back(k % 17 == 0 ? std::nanf("") : 150.0F * (1.0F + wave));
                     layers.mean_curvature_per_m.push_back(k % 17 == 0 ? std::nanf("") : 20.0F * wave);
                     layers.gaussian_curvature_per_m2.push_back(k % 17 == 0 ? std::nanf("") : 300.0F * wave * wave);
                   }
                 });
    const scene::SceneDescription& description = scene->description();
    const FrictionConfig& config = *description.config.friction;
    const scene::Layers layers = scene->read_level(0);
    // The workspace on the window's longer side.
    const double scale = c.workspace_m / ((std::min(c.window, kNodes) - 1) * kSpacing_m);

    const int nodes = std::min(c.window, kNodes);
    const scene::Layers window = scene->read(0, 0, 0, nodes, std::min(c.window, options.ny));
    const auto felt = haptics::make_surface(description, window, 0, scale, {});
    ThreadPool pool(2);
    const ReliefData relief = prepare_relief(layers, 0, false, 0.0, pool);
    const Paint shown = paint_relief(relief, description, ColourMode::friction, c.workspace_m);
    const auto pictures = pipeline::make_pictures(layers, description, {}, pool);
    const auto reported =
        std::ranges::find_if(pictures, [](const pipeline::Picture& picture) { return picture.name == "friction"; });
    ASSERT_NE(reported, pictures.end());
    ASSERT_EQ(reported->width, options.nx);
    const std::string workspace = length_text(0.1, TextStyle::typeset);
    EXPECT_EQ(reported->caption.find(workspace) != std::string::npos, c.law == FrictionConfig::Law::paper);

    for (int j = 0; j < options.ny; ++j) {
      for (int i = 0; i < options.nx; ++i) {
        const std::size_t k = layers.grid.lattice.index(i, j);
        const double expected = written_law(config, layers, k, scale, c.workspace_m);
        if (i < window.grid.lattice.nx && j < window.grid.lattice.ny) {
          ASSERT_NEAR(static_cast<double>(felt->mu_dynamic[window.grid.lattice.index(i, j)]), expected, 1e-6)
              << i << ", " << j;
        }
        const auto colour = colour_of(shown.legend.map, expected / shown.legend.high);
        for (std::size_t channel = 0; channel < 3; ++channel) {
          ASSERT_NEAR(shown.rgba[4 * k + channel], colour[channel], 1) << i << ", " << j;
        }
        const std::size_t pixel = static_cast<std::size_t>(options.ny - 1 - j) * static_cast<std::size_t>(options.nx) +
                                  static_cast<std::size_t>(i);
        // The report knows no device and says for which workspace it holds.
        const double desk = written_law(config, layers, k, scale * 0.1 / c.workspace_m, 0.1);
        ASSERT_NEAR(reported->pixels[pixel], 1.0 + 253.0 * desk / config.mu_max, 1.01) << i << ", " << j;
      }
    }
  }
}

}  // namespace
}  // namespace sparsha::viewer::test
