// Distance from points to the bilinear surface of a depth grid: by a pyramid of the heights that squares of cells span,
// and by walking the lattice outwards, which knows no pyramid and so judges it.
#pragma once

#include <vector>

#include "pipeline/check/patch.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

struct SurfaceDistance {
  double distance_m = 0;  ///< unsigned; infinite when the grid has no cell with four known nodes
  double signed_m = 0;    ///< the same, negative behind the surface
};

/// Immutable; queries are thread-safe. Points are relative to the lattice's origin, metres. Takes 2/3 byte a node. The
/// grid must outlive it.
class SurfaceIndex {
 public:
  explicit SurfaceIndex(const scene::DepthGrid& grid);

  /// Exact nearest distance; squares of cells that lie farther than what was found are left out with all in them.
  [[nodiscard]] SurfaceDistance distance(double x_m, double y_m, double z_m) const;
  /// The same by rings of cells about the point and by a search on their patches; gives up (infinite) when `max_rings`
  /// do not decide.
  [[nodiscard]] SurfaceDistance distance_by_walking(double x_m, double y_m, double z_m, int max_rings) const;

 private:
  /// Heights that a square of cells spans, relative to the lattice's origin, spacings; low > high where it has no cell.
  struct Span {
    float low, high;
  };
  /// Squares of the same size, row by row. Level 0 has squares of kBlock x kBlock cells, the last a single square.
  struct Level {
    int nx = 0, ny = 0;
    double side = 0;  ///< of a square, spacings
    std::vector<Span> spans;
    [[nodiscard]] const Span& at(int i, int j) const {
      return spans[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)];
    }
  };
  struct Best {
    double squared;
    double side;
  };
  /// A point relative to the lattice's origin, spacings.
  struct Place {
    double x, y, z;
  };
  using Closest = PatchPoint (*)(const Patch&, double, double, double) noexcept;
  [[nodiscard]] static Level halved(const Level& finer);
  [[nodiscard]] Span span_of_block(int i0, int j0) const;
  [[nodiscard]] static double squared_to(const Level& level, int i, int j, const Place& p);
  void offer_cell(int i, int j, const Place& p, Best& best, Closest closest = closest_on_patch) const;
  void offer_block(int i, int j, const Place& p, Best& best) const;
  void offer_square(std::size_t level, int i, int j, const Place& p, Best& best) const;
  [[nodiscard]] SurfaceDistance result(const Best& best) const;

  const scene::DepthGrid& grid_;
  double spacing_, per_spacing_;
  std::vector<Level> levels_;  ///< empty when the lattice has no cell
};

}  // namespace sparsha::pipeline
