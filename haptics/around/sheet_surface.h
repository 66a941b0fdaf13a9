// One sheet of a whole object as it is touched. Object frame: the axes of the grid frame, metres relative to the
// charts' origin. Local frame: that of the sheet's side, node (0, 0) at zero.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"
#include "scene/charts.h"

namespace sparsha::haptics {

/// What a cell of a sheet is worth to the proxy. A cell that is worth more than kLook is as many cells from the nearest
/// one that is not, less one: so far a proxy may go unwatched.
enum SheetCell : std::uint8_t {
  kNoCell = 0,    ///< nothing was measured here, nor near
  kRimCell = 1,   ///< continued from measured nodes, at most kRimCells away: edges lie there
  kLookCell = 2,  ///< measured, but steep, beside the rim or near to another sheet: the proxy looks about
  kOpenCell = 3,  ///< measured, and all cells about it too
};
inline constexpr int kRimCells = 2;

/// One sheet. Local frame: chart frame of its side, node (0, 0) of `surface` at zero, heights as in the charts.
struct SheetSurface {
  scene::SideAxes axes = scene::SideAxes::of(scene::Side::front);
  Eigen::Vector3d corner_m = Eigen::Vector3d::Zero();  ///< node (0, 0), chart frame
  std::shared_ptr<const MongeSurface> surface;
  std::uint32_t number = 0;         ///< of the charts' sheet that this is, or is a piece of
  std::vector<std::uint8_t> cells;  ///< (nx-1)*(ny-1) of SheetCell and more

  [[nodiscard]] Eigen::Vector3d to_local(const Eigen::Vector3d& object_m) const noexcept {
    return axes.to_chart(object_m) - corner_m;
  }
  [[nodiscard]] Eigen::Vector3d to_object(const Eigen::Vector3d& local_m) const noexcept {
    return axes.to_grid(Eigen::Vector3d(local_m + corner_m));
  }
  /// The same without the corner, for directions.
  [[nodiscard]] Eigen::Vector3d turn_to_object(const Eigen::Vector3d& local) const noexcept {
    return axes.to_grid(local);
  }
  /// Of cell (i, j); kNoCell outside.
  [[nodiscard]] std::uint8_t cell(int i, int j) const noexcept {
    const scene::Lattice& lattice = surface->lattice;
    if (i < 0 || j < 0 || i >= lattice.nx - 1 || j >= lattice.ny - 1) return kNoCell;
    return cells[static_cast<std::size_t>(j) * static_cast<std::size_t>(lattice.nx - 1) + static_cast<std::size_t>(i)];
  }
};

/// The cell of a place (object frame) in its sheet of the charts, with the sheet's number in the first index: cells of
/// two sheets differ, and those of two pieces of one sheet where they are at two places.
[[nodiscard]] std::array<std::int32_t, 2> recorded_cell(const SheetSurface& sheet, const Eigen::Vector3d& object_m,
                                                        double spacing_m) noexcept;

/// Coefficients of the whole object.
struct AroundFriction {
  double mu_dynamic = 0.0;
  double mu_static = 0.0;  ///< not below mu_dynamic
  /// Where they differ from place to place: {mu_dynamic, mu_static} of a place of the object frame whose texture bends
  /// so much (1/m; NaN: not known). Empty: they do not.
  std::function<std::array<float, 2>(const Eigen::Vector3d& object_m, double curvature_per_m)> at;
};

/// `friction` of zero: frictionless. Cells that are open are kOpenCell.
[[nodiscard]] SheetSurface make_sheet_surface(const scene::Charts& charts, const scene::Sheet& sheet,
                                              const AroundFriction& friction);

/// One for every cell that is measured or in a hole of at most 2 kRimCells cells among those, where a sheet has
/// `cells`.
[[nodiscard]] std::vector<std::uint8_t> close_holes(const SheetSurface& sheet, const std::vector<std::uint8_t>& cells);

/// The sheet in pieces that overlap, none of which lies beside itself at another height, but for very small ones: a
/// sheet that would lie over itself was cut, and its surface beyond the cut is not that on this side.
[[nodiscard]] std::vector<scene::Sheet> pieces_of(const scene::Sheet& sheet, double spacing_m);

/// A sheet as seen from a place: the surface under it along the sheet's own direction.
struct SheetView {
  std::uint8_t cell = kNoCell;
  double gap_m = 0.0;      ///< from the surface to the place along the normal, to first order; positive outside
  double facing = 0.0;     ///< cosine of the normal and the sheet's direction
  Eigen::Vector3d local;   ///< the place on the surface, local frame
  Eigen::Vector3d normal;  ///< outward unit normal, object frame
};

/// Bilinear; `cell` kNoCell leaves the rest unset.
[[nodiscard]] SheetView view_of(const SheetSurface& sheet, const Eigen::Vector3d& object_m) noexcept;

}  // namespace sparsha::haptics
