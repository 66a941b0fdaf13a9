// The lattice of a window of a level, and which lattices can be touched.
#pragma once

#include "base/error.h"
#include "scene/depth_grid.h"

namespace sparsha::scene {

/// Whether there is a cell between the nodes; what has none can be neither touched nor drawn.
[[nodiscard]] inline bool has_cell(const Lattice& lattice) { return lattice.nx >= 2 && lattice.ny >= 2; }

/// Nodes [i0, i0+nx) x [j0, j0+ny) of `level`; may reach beyond it. Throws Error{failure} for an empty or absurd
/// window.
[[nodiscard]] inline Lattice window_lattice(const Lattice& level, int i0, int j0, int nx, int ny) {
  constexpr int kLimit = 1 << 30;
  if (nx < 1 || ny < 1 || i0 < -kLimit || j0 < -kLimit || i0 > kLimit || j0 > kLimit || nx > kLimit || ny > kLimit) {
    throw Error(ErrorKind::failure, {}, "the window is empty or too large");
  }
  Lattice window = level;
  window.nx = nx;
  window.ny = ny;
  window.origin_m.x() += i0 * level.spacing_m;
  window.origin_m.y() += j0 * level.spacing_m;
  return window;
}

}  // namespace sparsha::scene
