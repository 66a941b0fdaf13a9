// Between metres and cells: where the state's proxy lies on the surface, and back.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/proxy.h"

namespace sparsha::haptics {

inline constexpr double kFarthestCell = 1e12;  ///< a hand beyond is no hand

/// x unless it is a whole number but for rounding: a hand on a line of nodes is exactly on it.
[[nodiscard]] inline double snapped_to_line(double x) noexcept {
  constexpr double kRounding = 2.0 * std::numeric_limits<double>::epsilon();
  constexpr double kToWhole = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to the nearest whole number
  const double whole = (x + kToWhole) - kToWhole;
  return std::abs(x - whole) <= kRounding * std::abs(x) ? whole : x;
}

/// The hand in cells.
template <class Surface>
[[nodiscard]] inline CellVector to_cells(const Surface& surface, const Eigen::Vector3d& local_m) noexcept {
  return {snapped_to_line(local_m.x() * surface.cells_per_m()), snapped_to_line(local_m.y() * surface.cells_per_m()),
          local_m.z() * surface.cells_per_m()};
}

/// False for NaN too.
[[nodiscard]] inline bool is_reachable(const CellVector& v) noexcept {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z) < kFarthestCell;
}

/// The cell that holds (x, y).
template <class Surface>
[[nodiscard]] inline CellPoint locate(const Surface& surface, const CellVector& v) noexcept {
  const auto cell = [](double x, int nodes) {
    if (x < 0.0) return -1;
    return x < nodes - 1 ? static_cast<int>(x) : nodes - 1;
  };
  CellPoint p;
  p.i = cell(v.x, surface.nx());
  p.j = cell(v.y, surface.ny());
  p.s = v.x - p.i;
  p.t = v.y - p.j;
  surface.keep_in_cell(p);
  p.z = v.z;
  return p;
}

template <class Surface>
[[nodiscard]] inline Eigen::Vector3d to_metres(const Surface& surface, const CellPoint& p) noexcept {
  return {(p.i + p.s) * surface.cell_m(), (p.j + p.t) * surface.cell_m(), p.z * surface.cell_m()};
}

/// Does the state's position still say that its proxy is at p, to the last bit?
template <class Surface>
[[nodiscard]] inline bool is_at(const Surface& surface, const CellPoint& p, const Eigen::Vector3d& position) noexcept {
  return (p.i + p.s) * surface.cell_m() == position.x() && (p.j + p.t) * surface.cell_m() == position.y() &&
         p.z * surface.cell_m() == position.z();
}

/// The state's proxy in cells: as the solver left it, or from metres when somebody moved it or changed the surface.
/// False when the position is no place at all.
template <class Surface>
[[nodiscard]] inline bool place_of(const Surface& surface, const ProxyState& state, CellPoint& p) noexcept {
  const ProxyCell& c = state.cell;
  p = {c.i, c.j, c.s, c.t, c.z};
  const bool in_range = static_cast<unsigned>(c.i + 1) <= static_cast<unsigned>(surface.nx()) &&
                        static_cast<unsigned>(c.j + 1) <= static_cast<unsigned>(surface.ny());
  if (in_range && is_at(surface, p, state.position)) [[likely]]
    return true;
  const CellVector place = to_cells(surface, state.position);
  if (!is_reachable(place)) return false;
  p = locate(surface, place);
  return true;
}

template <class Surface>
inline void keep_place(const Surface& surface, const CellPoint& p, ProxyState& state) noexcept {
  state.cell = {p.i, p.j, p.s, p.t, p.z, surface.cell_m(), surface.cells_per_m()};
  state.position = to_metres(surface, p);
}

}  // namespace sparsha::haptics
