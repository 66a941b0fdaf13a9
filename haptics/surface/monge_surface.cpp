#include "haptics/surface/monge_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/threads/progress.h"
#include "haptics/surface/large_pages.h"
#include "scene/ground/beyond.h"
#include "scene/ground/fingertip.h"

namespace sparsha::haptics {
namespace {

using scene::Lattice;

void check(const SurfaceParts& parts) {
  const Lattice& lattice = parts.lattice;
  const auto wrong = [](const char* what, const char* expected) {
    return Error(ErrorKind::failure, {}, what, expected);
  };
  if (lattice.nx < 2 || lattice.ny < 2 || !(lattice.spacing_m > 0.0) || !lattice.origin_m.allFinite())
    throw wrong("a surface without a cell", "at least 2 x 2 nodes and a positive spacing");
  if (!(parts.scale > 0.0) || !std::isfinite(parts.scale))
    throw wrong("a surface's scale that is not positive", "device metres per grid metre");
  if (!(parts.tip_radius_m >= 0.0) || !std::isfinite(parts.tip_radius_m) || parts.margin < 0)
    throw wrong("a fingertip's radius or margin that is negative", "a radius in device metres, a number of nodes");
  const std::size_t count = lattice.count();
  const std::size_t cells = static_cast<std::size_t>(lattice.nx - 1) * static_cast<std::size_t>(lattice.ny - 1);
  const auto nodes = [&](int n) { return static_cast<std::size_t>(n) + 2 * static_cast<std::size_t>(parts.margin); };
  if (parts.height_m.size() != nodes(lattice.nx) * nodes(lattice.ny))
    throw wrong("heights that are not one per node", "nx * ny heights, and those of the margin");
  for (const std::vector<float>* friction : {&parts.friction.mu_dynamic, &parts.friction.mu_static})
    if (!friction->empty() && friction->size() != count)
      throw wrong("friction coefficients that are not one per node", "nx * ny coefficients or none");
  if (parts.friction.mu_dynamic.empty() != parts.friction.mu_static.empty())
    throw wrong("one of two friction coefficients is missing", "both or none");
  if (!parts.cell_flags.empty() && parts.cell_flags.size() != cells)
    throw wrong("cell flags that are not one per cell", "(nx - 1) * (ny - 1) flags or none");
}

/// kCellUnknown where a node of the cell is unknown; empty when all are known.
std::vector<std::uint8_t> flag_unknown(const Lattice& lattice, const std::vector<float>& height_m) {
  const auto unknown = [&](int i, int j) { return !std::isfinite(height_m[lattice.index(i, j)]); };
  std::vector<std::uint8_t> cells;
  if (std::all_of(height_m.begin(), height_m.end(), [](float z) { return std::isfinite(z); })) return cells;
  cells.reserve(static_cast<std::size_t>(lattice.nx - 1) * static_cast<std::size_t>(lattice.ny - 1));
  for (int j = 0; j + 1 < lattice.ny; ++j)
    for (int i = 0; i + 1 < lattice.nx; ++i) {
      const bool any = unknown(i, j) || unknown(i + 1, j) || unknown(i, j + 1) || unknown(i + 1, j + 1);
      cells.push_back(any ? static_cast<std::uint8_t>(kCellUnknown) : std::uint8_t{0});
    }
  return cells;
}

/// `height` without `margin` nodes on every side.
std::vector<float> cropped(const std::vector<float>& height, const Lattice& lattice, int margin) {
  std::vector<float> result = reserve_large(lattice.count());
  const auto row = static_cast<std::ptrdiff_t>(lattice.nx) + 2 * margin;
  for (int j = 0; j < lattice.ny; ++j) {
    const auto begin = height.begin() + (j + margin) * row + margin;
    result.insert(result.end(), begin, begin + lattice.nx);
  }
  return result;
}

}  // namespace

int margin_of(double tip_radius_m, double scale, double spacing_m) {
  const double nodes = std::ceil(tip_radius_m / (scale * spacing_m));
  return nodes > 0.0 ? static_cast<int>(std::min(nodes, 1e4)) : 0;
}

double MongeSurface::height(double x, double y) const noexcept {
  const double u = std::clamp(x / lattice.spacing_m, 0.0, static_cast<double>(lattice.nx - 1));
  const double v = std::clamp(y / lattice.spacing_m, 0.0, static_cast<double>(lattice.ny - 1));
  if (std::isnan(u) || std::isnan(v)) return std::numeric_limits<double>::quiet_NaN();
  const int i = std::min(static_cast<int>(u), std::max(lattice.nx - 2, 0));
  const int j = std::min(static_cast<int>(v), std::max(lattice.ny - 2, 0));
  const int i1 = std::min(i + 1, lattice.nx - 1);
  const int j1 = std::min(j + 1, lattice.ny - 1);
  const double s = u - i;
  const double t = v - j;
  const double low = (1.0 - s) * static_cast<double>(height_m[lattice.index(i, j)]) +
                     s * static_cast<double>(height_m[lattice.index(i1, j)]);
  const double high = (1.0 - s) * static_cast<double>(height_m[lattice.index(i, j1)]) +
                      s * static_cast<double>(height_m[lattice.index(i1, j1)]);
  return (1.0 - t) * low + t * high;
}

std::shared_ptr<const MongeSurface> make_surface(SurfaceParts parts) {
  const auto throw_if_cancelled = [&] {
    if (parts.progress != nullptr) parts.progress->throw_if_cancelled();
  };
  check(parts);
  throw_if_cancelled();
  auto surface = std::make_shared<MongeSurface>();
  surface->lattice = parts.lattice;
  surface->id = parts.id;
  surface->level = parts.level;
  surface->scale = parts.scale;
  surface->tip_radius_m = parts.tip_radius_m;
  surface->effects = std::move(parts.effects);
  surface->height_m = std::move(parts.height_m);
  if (parts.cell_flags.empty())
    parts.cell_flags = flag_unknown(
        parts.lattice, parts.margin > 0 ? cropped(surface->height_m, parts.lattice, parts.margin) : surface->height_m);
  surface->cell_flags = std::move(parts.cell_flags);
  throw_if_cancelled();
  const int nx = parts.lattice.nx + 2 * parts.margin;
  const int ny = parts.lattice.ny + 2 * parts.margin;
  surface->beyond = parts.beyond;
  scene::continue_beyond(surface->height_m, nx, ny, {parts.lattice.spacing_m, parts.scale, parts.hole_m, parts.beyond});
  throw_if_cancelled();
  scene::touch_with_ball(surface->height_m, nx, ny, parts.lattice.spacing_m, parts.tip_radius_m / parts.scale,
                         parts.progress);
  if (parts.margin > 0) surface->height_m = cropped(surface->height_m, parts.lattice, parts.margin);
  surface->mu_dynamic = std::move(parts.friction.mu_dynamic);
  surface->mu_static = std::move(parts.friction.mu_static);
  surface->highest_m = *std::max_element(surface->height_m.begin(), surface->height_m.end());
  const double middle_x = 0.5 * surface->width_m();
  const double middle_y = 0.5 * surface->depth_m();
  surface->centre_m = parts.centre_m.value_or(parts.lattice.origin_m +
                                              Eigen::Vector3d(middle_x, middle_y, surface->height(middle_x, middle_y)));
  return surface;
}

}  // namespace sparsha::haptics
