#include "haptics/window/window.h"

#include "haptics/window/effects.h"
#include "haptics/window/objects.h"
#include "haptics/window/surface.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "scene/folder/repeated_read.h"
#include "scene/frame/touched_view.h"
#include "scene/frame/workspace.h"
#include "scene/ground/window_lattice.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

using scene::Lattice;

constexpr double kNearestScale = 8.0;  // device metres per grid metre
constexpr double kFarthestNodes_m =
    0.004;                           // between nodes, device frame: beyond, a window shows its cells and no stone
constexpr double kWorthAStep = 1.2;  // times nearer

/// First node of a run of `window` nodes around `centre`, or all `n` nodes when they fit.
std::pair<int, int> run_around(double centre_nodes, int n, int window) {
  if (n <= window) return {0, n};
  const double first = std::round(centre_nodes - 0.5 * (window - 1));
  return {static_cast<int>(std::clamp(first, -1e9, 1e9)), window};
}

}  // namespace

scene::TouchedView view_of(const WindowPlan& plan) {
  return {plan.level,           plan.i0,    plan.j0, plan.nx, plan.ny, plan.scale, plan.tip_radius_m,
          plan.effects.texture, plan.beyond};
}

bool touches_all_around(const scene::SceneDescription& scene) {
  return scene.charts != nullptr && scene.config.haptics.solver == scene::HapticsConfig::Solver::exact;
}

int overview_level(const scene::SceneDescription& scene) {
  const int window = scene::window_nodes(scene.config.levels.window);
  int coarsest = 0;
  for (std::size_t level = 0; level < scene.levels.size() && scene::has_cell(scene.levels[level]); ++level) {
    coarsest = static_cast<int>(level);
    if (std::max(scene.levels[level].nx, scene.levels[level].ny) <= window) break;
  }
  return coarsest;
}

Eigen::Vector2d middle_of(const Lattice& lattice) {
  return {lattice.origin_m.x() + 0.5 * (lattice.nx - 1) * lattice.spacing_m,
          lattice.origin_m.y() + 0.5 * (lattice.ny - 1) * lattice.spacing_m};
}

std::vector<ZoomStep> zoom_steps(const scene::SceneDescription& scene, double workspace_width_m) {
  const int window = scene::window_nodes(scene.config.levels.window);
  std::vector<ZoomStep> steps;
  for (int level = overview_level(scene); level >= 0; --level) steps.push_back({level, window});
  const Lattice& finest = scene.levels.front();
  const double nearest = std::min(kNearestScale, kFarthestNodes_m / finest.spacing_m);
  double scale = scene::level_scale(window, finest, workspace_width_m);
  for (double next = std::exp2(std::ceil(std::log2(kWorthAStep * scale))); scale * kWorthAStep < nearest; next *= 2.0) {
    scale = next * kWorthAStep < nearest ? next : nearest;
    const double cells = workspace_width_m / (scale * finest.spacing_m);
    const int nodes = scene::window_nodes(1 + static_cast<int>(std::lround(cells)));
    if (nodes >= steps.back().nodes) break;  // no smaller window is worth touching
    steps.push_back({0, nodes});
  }
  return steps;
}

WindowPlan plan_window(const scene::SceneDescription& scene, int level, const Eigen::Vector2d& centre_m,
                       double workspace_width_m) {
  return plan_window(scene, ZoomStep{level, scene::window_nodes(scene.config.levels.window)}, centre_m,
                     workspace_width_m);
}

WindowPlan plan_window(const scene::SceneDescription& scene, const ZoomStep& step, const Eigen::Vector2d& centre_m,
                       double workspace_width_m) {
  const Lattice& lattice = scene.levels.at(static_cast<std::size_t>(step.level));
  const int window = step.nodes;
  WindowPlan plan;
  plan.level = step.level;
  plan.nodes = step.nodes;
  const Eigen::Vector2d nodes = (centre_m - lattice.origin_m.head<2>()) / lattice.spacing_m;
  std::tie(plan.i0, plan.nx) = run_around(nodes.x(), lattice.nx, window);
  std::tie(plan.j0, plan.ny) = run_around(nodes.y(), lattice.ny, window);
  plan.scale = workspace_width_m / scene::window_width_m(plan.nx, plan.ny, lattice.spacing_m);
  plan.impact = scene.config.haptics.impact;
  plan.around = touches_all_around(scene);
  plan.tip_radius_m = plan.around ? 0.0 : scene.config.haptics.tip_radius_m;
  plan.grain = scene.config.haptics.grain;
  plan.cues = scene.config.cues.has_value();
  plan.beyond = scene.config.haptics.beyond;
  const int fall = scene::fall_nodes(scene::beyond_of(scene, view_of(plan)));
  if (plan.nx == lattice.nx) plan.i0 -= fall, plan.nx += 2 * fall;
  if (plan.ny == lattice.ny) plan.j0 -= fall, plan.ny += 2 * fall;
  return plan;
}

HapticWindow load_window(const scene::Scene& scene, const WindowPlan& plan, std::uint64_t id,
                         const Progress* progress) {
  const scene::SceneDescription& description = scene.description();
  const Lattice& level = description.levels.at(static_cast<std::size_t>(plan.level));
  SurfaceOptions options;
  options.progress = progress;
  options.tip_radius_m = plan.tip_radius_m;
  options.beyond = plan.beyond;
  options.margin = scene::margin_of(description, view_of(plan));
  const int more = 2 * options.margin;
  const scene::Layers layers = scene::read_repeated(scene, plan.level, plan.i0 - options.margin,
                                                    plan.j0 - options.margin, plan.nx + more, plan.ny + more);
  options.effects = plan.effects;
  options.id = id;
  options.surface_effects = make_effects(scene, plan, layers.grid);
  HapticWindow window;
  window.surface = make_surface(description, layers, plan.level, plan.scale, options);
  window.i0 = plan.i0;
  window.j0 = plan.j0;
  window.level_nx = level.nx;
  window.level_ny = level.ny;
  window.id = id;
  window.effects = plan.effects;
  if (plan.around) attach_object(window, description);
  window.turned = description.region_from_grid.has_value();
  if (window.turned) window.region_from_grid = description.region_from_grid->topRows<3>();
  return window;
}

}  // namespace sparsha::haptics
