// The cells a surface point touches: one inside a cell, two on an edge, four on a node.
#pragma once

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/tangent_cone.h"

namespace sparsha::haptics {

/// A touching cell: the point written in that cell's coordinates and how it may move there.
struct TouchingCell {
  CellPoint point;
  Freedom s = Freedom::both;
  Freedom t = Freedom::both;
};

struct TouchingCells {
  TouchingCell cell[4];
  int count = 0;
};

template <class Surface>
[[nodiscard]] inline bool is_inside_cell(const Surface& surface, const CellPoint& p) noexcept {
  return (p.s > 0.0 || !surface.has_low_s(p.i)) && (p.s < 1.0 || !surface.has_high_s(p.i)) &&
         (p.t > 0.0 || !surface.has_low_t(p.j)) && (p.t < 1.0 || !surface.has_high_t(p.j));
}

template <class Surface>
[[nodiscard]] TouchingCells touching_cells(const Surface& surface, const CellPoint& p) noexcept {
  struct Side {
    int cell;
    double place;
    Freedom freedom;
  };
  Side along_s[2] = {{p.i, p.s, Freedom::both}, {0, 0.0, Freedom::both}};
  Side along_t[2] = {{p.j, p.t, Freedom::both}, {0, 0.0, Freedom::both}};
  int count_s = 1;
  int count_t = 1;
  if (p.s == 0.0 && surface.has_low_s(p.i)) {
    along_s[0].freedom = Freedom::up;
    along_s[count_s++] = {p.i - 1, 1.0, Freedom::down};
  } else if (p.s == 1.0 && surface.has_high_s(p.i)) {
    along_s[0].freedom = Freedom::down;
    along_s[count_s++] = {p.i + 1, 0.0, Freedom::up};
  }
  if (p.t == 0.0 && surface.has_low_t(p.j)) {
    along_t[0].freedom = Freedom::up;
    along_t[count_t++] = {p.j - 1, 1.0, Freedom::down};
  } else if (p.t == 1.0 && surface.has_high_t(p.j)) {
    along_t[0].freedom = Freedom::down;
    along_t[count_t++] = {p.j + 1, 0.0, Freedom::up};
  }
  TouchingCells cells;
  for (int b = 0; b < count_t; ++b)
    for (int a = 0; a < count_s; ++a)
      cells.cell[cells.count++] = {{along_s[a].cell, along_t[b].cell, along_s[a].place, along_t[b].place, p.z},
                                   along_s[a].freedom,
                                   along_t[b].freedom};
  return cells;
}

}  // namespace sparsha::haptics
