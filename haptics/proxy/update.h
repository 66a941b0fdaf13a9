// What a solver found, in metres, for the rooms outside the solver.
#pragma once

#include "haptics/proxy/fast_path.h"
#include "haptics/proxy/hot.h"
#include "haptics/proxy/place.h"
#include "haptics/proxy/touching_cells.h"

namespace sparsha::haptics {

/// Flags of the cell that holds p, or of the border cell nearest to it.
[[nodiscard]] SPARSHA_HOT inline std::uint8_t flags_at(const MongeSurface& surface, const CellPoint& p) noexcept {
  if (surface.cell_flags.empty()) return 0;
  const int i = std::clamp(p.i, 0, surface.lattice.nx - 2);
  const int j = std::clamp(p.j, 0, surface.lattice.ny - 2);
  return surface.cell_flags[static_cast<std::size_t>(j) * static_cast<std::size_t>(surface.lattice.nx - 1) +
                            static_cast<std::size_t>(i)];
}

[[nodiscard]] SPARSHA_HOT inline Eigen::Vector3d unit_normal(double fs, double ft) noexcept {
  const double inverse = 1.0 / std::sqrt(1.0 + fs * fs + ft * ft);
  return {-fs * inverse, -ft * inverse, inverse};
}

[[nodiscard]] SPARSHA_HOT inline Eigen::Vector3d unit_vector(const CellVector& v) noexcept {
  const double inverse = 1.0 / std::sqrt(v.z * v.z + v.x * v.x + v.y * v.y);
  return {v.x * inverse, v.y * inverse, v.z * inverse};
}

/// The patch's normal, or the mean of the touching patches' on edges and nodes.
template <class Surface>
[[nodiscard]] inline Eigen::Vector3d normal_at(const Surface& surface, const CellPoint& p) noexcept {
  const auto unit = [&surface](const CellPoint& q) {
    const auto patch = surface.patch(q.i, q.j);
    return unit_normal(patch.slope_s(q.s, q.t), patch.slope_t(q.s, q.t));
  };
  if (is_inside_cell(surface, p)) return unit(p);
  const TouchingCells touching = touching_cells(surface, p);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < touching.count; ++k) sum += unit(touching.cell[k].point);
  return sum.normalized();
}

/// Stores the solver's end point in the state and reports it. A free proxy is the hand itself, to the last bit.
template <class Surface>
[[nodiscard]] inline ProxyUpdate report(const MongeSurface& monge, const Surface& surface, const Eigen::Vector3d& hip,
                                        const CellPoint& p, bool at_hand, const RestPlace& place,
                                        ProxyState& state) noexcept {
  keep_place(surface, p, state);
  if (at_hand) state.position = hip;
  ProxyUpdate update;
  update.position = state.position;
  update.contact = state.contact;
  update.sticking = state.sticking;
  update.cell_flags = flags_at(monge, p);
  if (!state.contact) return update;
  if (place.known) {
    update.normal = unit_vector(place.normal);
    update.mu_dynamic = place.mu_dynamic;
  } else {
    update.normal = normal_at(surface, p);
    if (surface.has_friction()) update.mu_dynamic = surface.mu_dynamic(p.i, p.j, p.s, p.t);
  }
  if (surface.has_friction()) update.mu_static = surface.mu_static(p.i, p.j, p.s, p.t);
  return update;
}

/// The same for a proxy that the fast path brought to rest strictly inside an inner cell.
template <bool kFriction, class Surface>
[[nodiscard]] SPARSHA_HOT inline ProxyUpdate report_rest(const MongeSurface& monge, const Surface& surface,
                                                         const CellPoint& p, const RestPlace& place,
                                                         const SolverState& course, ProxyState& state) noexcept {
  surface.prefetch_around(p.i, p.j);
  keep_place(surface, p, state);
  state.sticking = course.sticking;
  ProxyUpdate update;
  update.position = state.position;
  update.normal = unit_vector(place.normal);
  update.mu_dynamic = place.mu_dynamic;
  if constexpr (kFriction) update.mu_static = surface.mu_static(p.i, p.j, p.s, p.t);
  update.contact = true;
  update.sticking = course.sticking;
  update.segments = course.segments;
  update.cell_flags = flags_at(monge, p);
  return update;
}

/// No hand: nothing moves, nothing pushes.
[[nodiscard]] inline ProxyUpdate report_no_hand(const ProxyState& state) noexcept {
  ProxyUpdate update;
  update.position = state.position;
  return update;
}

}  // namespace sparsha::haptics
