// 1 m relief at 512 nodes, noise 0.2 mm, 0.5 % outliers unless a scene says otherwise.
#include "bench/pipeline/scenes.h"

#include <cmath>

#include <fmt/format.h>

namespace sparsha::bench {
namespace {

using pipeline::BackConfig;
using pipeline::SamplerConfig;

constexpr double kNoise_m = 0.0002;

Scene scene(std::string name, double points_per_node, const pipeline::Form& form = pipeline::AccuracyForm{}) {
  Scene s;
  s.name = std::move(name);
  s.config.seed = 20;
  s.config.nodes = 512;
  s.config.surface.form = form;
  s.config.noise_m = kNoise_m;
  s.config.outlier_fraction = 0.005;
  s.config.outlier_spread_m = 0.05;
  s.config.scan = SamplerConfig{points_per_node, 1.0, 1};
  return s;
}

Scene with_back(Scene s, BackConfig::Kind kind, double depth_m, double density) {
  s.config.surface.back = {kind, depth_m, 0.003, density};
  return s;
}

}  // namespace

std::vector<Scene> accuracy_scenes(bool quick) {
  std::vector<Scene> scenes;
  const auto add = [&](Scene s) -> Scene& {
    scenes.push_back(std::move(s));
    return scenes.back();
  };
  Scene& sparse = add(with_back(scene("sparse back, 3.6 per node", 3.6), BackConfig::Kind::rough, 0.10, 0.1));
  sparse.rms_away_mm = 0.10;
  sparse.p99_away_mm = 0.34;
  sparse.off2_away_percent = 0.003;
  sparse.off5_all_percent = 0.03;
  sparse.least_coverage_percent = 99.5;
  Scene& slab = add(with_back(scene("slab, 1.9 per node on both sides", 1.9), BackConfig::Kind::parallel, 0.06, 1.0));
  slab.rms_away_mm = 0.13;
  slab.p99_away_mm = 0.40;
  slab.off2_away_percent = 0.003;
  slab.off5_all_percent = 0.03;
  slab.least_coverage_percent = 99.5;
  add(with_back(scene("parallel back 8 mm behind, 3.6", 3.6), BackConfig::Kind::parallel, 0.008, 1.0))
      .off5_all_percent = 0.03;
  add(scene("plane at 56 degrees, 3.6", 3.6, pipeline::PlaneForm{1.4826, 0.0}));
  for (int width = 1; width <= 4; ++width) {
    const pipeline::BarsForm bars{0.006, width / 511.0, 0.05, true};
    Scene& s = add(scene(fmt::format("6 mm bars, {} node(s) wide, 3.6", width), 3.6, bars));
    if (width >= 2) s.least_beside_percent = 85.0;
  }
  if (!quick) add(with_back(scene("32 per node", 32.0), BackConfig::Kind::rough, 0.10, 0.1)).rms_all_mm = 0.05;
  Scene& varying = add(scene("density varying 1:100, mean 3.6", 3.6));
  std::get<SamplerConfig>(varying.config.scan).density_ratio = 100.0;
  add(scene("grid three times finer than the cloud", 1.0 / 9.0));
  Scene& utm = add(with_back(scene("georeferenced, double, 3.6", 3.6), BackConfig::Kind::rough, 0.10, 0.1));
  utm.config.origin_m = {450000.25, 5412000.5, 312.0};
  utm.config.double_precision = true;
  utm.rms_away_mm = 0.11;
  Scene& facade = add(scene("facade seen horizontally in UTM, 3.6", 3.6, pipeline::FacadeForm{}));
  facade.config.surface.width_m = 8.0;
  facade.config.surface.height_m = 5.0;
  facade.config.origin_m = {450000.25, 5412000.5, 312.0};
  facade.config.look_from = {0.6, 0.8, 0.0};
  facade.config.up = {0.0, 0.0, 1.0};
  facade.config.double_precision = true;
  for (const double n : {2.0, 4.0, 8.0, 16.0, 32.0}) {
    if (quick && n > 8.0) break;
    Scene& s = add(scene(fmt::format("smooth parts, {} a node", n), n));
    s.rms_smooth_mm = 0.7 * 1e3 * kNoise_m / std::sqrt(n);
  }
  return scenes;
}

}  // namespace sparsha::bench
