#include "haptics/effects/surface_effects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::haptics {

bool SurfaceEffects::has_stiffness() const noexcept {
  return std::any_of(parts.begin(), parts.end(), [](const Part& part) { return part.stiffness_n_per_m.has_value(); });
}

double SurfaceEffects::stiffness_at(const Eigen::Vector3d& place_m, double base_n_per_m) const noexcept {
  double stiffness = base_n_per_m;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part)
    if (part->stiffness_n_per_m)
      stiffness += (*part->stiffness_n_per_m - stiffness) * part->area.share_inside(place_m, border_m);
  return stiffness;
}

const scene::MaterialTouch& SurfaceEffects::material_at(const Eigen::Vector3d& place_m) const noexcept {
  for (const Part& part : parts)
    if (part.material && part.area.decides(place_m, border_m)) return scene::touch_of(*part.material);
  return scene::touch_of(material);
}

double SurfaceEffects::grain_gain_at(const Eigen::Vector3d& place_m) const noexcept {
  double gain = scene::touch_of(material).grain_gain;
  for (auto part = parts.rbegin(); part != parts.rend(); ++part)
    if (part->material)
      gain += (scene::touch_of(*part->material).grain_gain - gain) * part->area.share_inside(place_m, border_m);
  return gain;
}

std::size_t SurfaceEffects::part_at(const Eigen::Vector3d& place_m) const noexcept {
  for (std::size_t part = 0; part < part_areas.size(); ++part)
    if (part_areas[part].holds(place_m)) return part;
  return kNoPart;
}

namespace {

/// The node of a lattice that is nearest to a place, and how far beyond the lattice's edge the place lies, in spacings.
struct NearestNode {
  std::size_t node = 0;
  double beyond = 0.0;
};

NearestNode nearest_node(const scene::Lattice& lattice, double x_m, double y_m) noexcept {
  const double u = (x_m - lattice.origin_m.x()) / lattice.spacing_m;
  const double v = (y_m - lattice.origin_m.y()) / lattice.spacing_m;
  const double inside_u = std::clamp(u, 0.0, static_cast<double>(lattice.nx - 1));
  const double inside_v = std::clamp(v, 0.0, static_cast<double>(lattice.ny - 1));
  return {lattice.index(static_cast<int>(std::lround(inside_u)), static_cast<int>(std::lround(inside_v))),
          std::hypot(u - inside_u, v - inside_v)};
}

}  // namespace

double SurfaceEffects::to_stone_m(double x_m, double y_m) const noexcept {
  if (stone_m.empty()) return 0.0;
  const NearestNode nearest = nearest_node(stone_lattice, x_m, y_m);
  return static_cast<double>(stone_m[nearest.node]) + stone_lattice.spacing_m * nearest.beyond;
}

double SurfaceEffects::stone_z_m(double x_m, double y_m) const noexcept {
  return stone_lattice.origin_m.z() + static_cast<double>(stone_height_m[nearest_node(stone_lattice, x_m, y_m).node]);
}

// Two sweeps, each with the neighbours that it has passed (Rosenfeld & Pfaltz 1966).
std::vector<float> distance_to_stone(const scene::DepthGrid& grid) {
  const scene::Lattice& lattice = grid.lattice;
  const auto straight = static_cast<float>(lattice.spacing_m);
  const auto oblique = static_cast<float>(std::numbers::sqrt2 * lattice.spacing_m);
  const auto most = static_cast<float>(std::max(lattice.nx, lattice.ny)) * straight;
  std::vector<float> distance_m(lattice.count(), most);
  for (std::size_t node = 0; node < distance_m.size(); ++node)
    if (grid.state[node] != scene::NodeState::unknown) distance_m[node] = 0.0F;
  const auto sweep = [&](int i, int j, int back) {
    float& here = distance_m[lattice.index(i, j)];
    const auto from = [&](int di, int dj, float step) {
      const int ni = i + di;
      const int nj = j + dj;
      if (ni >= 0 && nj >= 0 && ni < lattice.nx && nj < lattice.ny)
        here = std::min(here, distance_m[lattice.index(ni, nj)] + step);
    };
    from(-back, 0, straight);
    from(-1, -back, oblique);
    from(0, -back, straight);
    from(1, -back, oblique);
  };
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) sweep(i, j, 1);
  for (int j = lattice.ny - 1; j >= 0; --j)
    for (int i = lattice.nx - 1; i >= 0; --i) sweep(i, j, -1);
  return distance_m;
}

}  // namespace sparsha::haptics
