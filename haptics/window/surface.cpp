#include "haptics/window/surface.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/error.h"
#include "haptics/surface/large_pages.h"
#include "scene/frame/touched_view.h"
#include "scene/frame/workspace.h"
#include "scene/ground/window_lattice.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

using scene::Lattice;
using scene::Layers;
using scene::NodeState;

void check(const scene::SceneDescription& scene, const Layers& window, int level, double scale) {
  const Lattice& lattice = window.grid.lattice;
  const auto wrong = [](const char* what) {
    return Error(ErrorKind::failure, {}, what, "a window read from the scene");
  };
  if (!scene::has_cell(lattice) || !(lattice.spacing_m > 0.0)) throw wrong("a haptic window without a cell");
  if (level < 0 || static_cast<std::size_t>(level) >= scene.levels.size())
    throw wrong("a level that the scene has not");
  if (!(scale > 0.0) || !std::isfinite(scale)) throw wrong("a window's scale that is not positive");
  const std::size_t count = lattice.count();
  const auto fits = [count](std::size_t size) { return size == 0 || size == count; };
  if (window.grid.height_m.size() != count || window.grid.state.size() != count || !fits(window.envelope_m.size()) ||
      !fits(window.curvature_per_m.size()) || !fits(window.mean_curvature_per_m.size()) ||
      !fits(window.gaussian_curvature_per_m2.size()))
    throw wrong("layers of a haptic window that differ in size");
}

/// Is a node of the window one of the level's own?
class Inside {
 public:
  Inside(const Lattice& level, const Lattice& window)
      : first_i_(std::lround((window.origin_m.x() - level.origin_m.x()) / level.spacing_m)),
        first_j_(std::lround((window.origin_m.y() - level.origin_m.y()) / level.spacing_m)),
        nx_(level.nx),
        ny_(level.ny) {}
  [[nodiscard]] bool operator()(int i, int j) const {
    return first_i_ + i >= 0 && first_i_ + i < nx_ && first_j_ + j >= 0 && first_j_ + j < ny_;
  }

 private:
  long first_i_;
  long first_j_;
  long nx_;
  long ny_;
};

std::vector<std::uint8_t> flag_cells(const Layers& window, const Inside& inside) {
  const Lattice& lattice = window.grid.lattice;
  std::vector<std::uint8_t> nodes(lattice.count(), 0);
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t node = lattice.index(i, j);
      if (!inside(i, j))
        nodes[node] = kCellOutside;
      else if (window.grid.state[node] == NodeState::unknown)
        nodes[node] = kCellUnknown;
      else if (window.grid.state[node] == NodeState::filled)
        nodes[node] = kCellFilled;
    }
  std::vector<std::uint8_t> cells;
  cells.reserve(static_cast<std::size_t>(lattice.nx - 1) * static_cast<std::size_t>(lattice.ny - 1));
  for (int j = 0; j + 1 < lattice.ny; ++j)
    for (int i = 0; i + 1 < lattice.nx; ++i) {
      const unsigned low = nodes[lattice.index(i, j)] | unsigned{nodes[lattice.index(i + 1, j)]};
      const unsigned high = nodes[lattice.index(i, j + 1)] | unsigned{nodes[lattice.index(i + 1, j + 1)]};
      cells.push_back(static_cast<std::uint8_t>(low | high));
    }
  return cells;
}

template <typename Value>
void crop(std::vector<Value>& values, int nx, int ny, int margin) {
  if (values.empty()) return;
  std::vector<Value> inner;
  inner.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
  for (int j = margin; j < ny - margin; ++j) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(j) * nx;
    inner.insert(inner.end(), row + margin, row + (nx - margin));
  }
  values = std::move(inner);
}

/// What touch needs of the layers, without the margin.
Layers without_margin(const Layers& wide, int margin) {
  Layers window;
  const int nx = wide.grid.lattice.nx;
  const int ny = wide.grid.lattice.ny;
  window.grid = wide.grid;
  window.grid.lattice = scene::window_lattice(wide.grid.lattice, margin, margin, nx - 2 * margin, ny - 2 * margin);
  window.envelope_m = wide.envelope_m;
  window.curvature_per_m = wide.curvature_per_m;
  window.mean_curvature_per_m = wide.mean_curvature_per_m;
  window.gaussian_curvature_per_m2 = wide.gaussian_curvature_per_m2;
  crop(window.grid.state, nx, ny, margin);
  for (std::vector<float>* values : {&window.grid.height_m, &window.envelope_m, &window.curvature_per_m,
                                     &window.mean_curvature_per_m, &window.gaussian_curvature_per_m2})
    crop(*values, nx, ny, margin);
  return window;
}

}  // namespace

FrictionMap evaluate_friction(const scene::SceneDescription& scene, const scene::Layers& window, int level,
                              double scale) {
  FrictionMap map;
  if (!scene.config.friction) return map;
  const scene::Lattice& lattice = window.grid.lattice;
  const double width_m = scene::window_width_m(lattice.nx, lattice.ny, scene.levels[static_cast<std::size_t>(level)]);
  const scene::FrictionLaw law(scene, scale, scale * width_m);
  for (std::vector<float>* values : {&map.mu_dynamic, &map.mu_static}) {
    *values = reserve_large(lattice.count());
    values->resize(lattice.count());
  }
  for (std::size_t node = 0; node < lattice.count(); ++node) {
    if (window.grid.state[node] == scene::NodeState::unknown) continue;
    map.mu_dynamic[node] = law.dynamic(window, node);
    map.mu_static[node] = law.at_rest(window, node, map.mu_dynamic[node]);
  }
  return map;
}

std::shared_ptr<const MongeSurface> make_surface(const scene::SceneDescription& scene, const Layers& layers, int level,
                                                 double scale, const SurfaceOptions& options) {
  check(scene, layers, level, scale);
  const bool wide = options.margin > 0;
  const Layers inner = wide ? without_margin(layers, options.margin) : Layers{};
  const Layers& window = wide ? inner : layers;
  const Lattice& lattice = window.grid.lattice;
  SurfaceParts parts;
  parts.lattice = lattice;
  parts.cell_flags = flag_cells(window, Inside(scene.levels[static_cast<std::size_t>(level)], lattice));
  parts.height_m = reserve_large(layers.grid.height_m.size());
  scene::known_heights(layers, options.effects.texture, parts.height_m);
  parts.beyond = options.beyond;
  if (scene.config.fill) parts.hole_m = scene.config.fill->max_gap_m;
  parts.tip_radius_m = options.tip_radius_m;
  parts.margin = options.margin;
  if (options.effects.friction) parts.friction = evaluate_friction(scene, window, level, scale);
  parts.scale = scale;
  parts.level = level;
  parts.id = options.id;
  parts.centre_m = options.centre_m;
  parts.effects = options.surface_effects;
  parts.progress = options.progress;
  return make_surface(std::move(parts));
}

}  // namespace sparsha::haptics
