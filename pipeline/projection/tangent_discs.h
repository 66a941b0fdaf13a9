// The surface as discs: around each point the plane through its nearest neighbours in space. They tell a steep flank
// from two layers where windows in x and y cannot (docs/architecture.md, "Closed objects").
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"
#include "pipeline/projection/buffer.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {

/// How discs are drawn.
struct DiscRule {
  static constexpr double kReach = 2.5;          ///< radius of a disc, local point spacings
  static constexpr double kMostSpacings = 3.0;   ///< of evenly scanned objects
  static constexpr double kDenseSpacings = 2.0;  ///< medians between points that are not taken for scattered ones

  double spacing_m = 0.0;  ///< median point spacing on the surface, times the scale of SurfaceStatistics
  double noise_m = 0.0;    ///< standard deviation across the surface
  bool scattered = false;  ///< points lie scattered in space, too: those far apart must lie in a plane
  bool lines = false;      ///< points lie on lines between which a front may be taken for two layers
  int neighbours = 14;     ///< points that a plane is drawn through, about
  double least_nz = 0.12;  ///< z of the normals of discs that are used
  /// Points farther apart than so many medians are no surface. Objects that were scanned from near and from far have
  /// dense and sparse regions.
  double most_spacings = kMostSpacings;

  /// Radius of the widest disc, columns (disc_column_m), rounded up.
  [[nodiscard]] int widest() const { return static_cast<int>(std::ceil(most_spacings)); }
};

/// Side of the columns that discs are found in: most discs reach no farther.
[[nodiscard]] inline double disc_column_m(const DiscRule& rule) { return DiscRule::kReach * rule.spacing_m; }

/// How far beyond a node lie the points that may decide about it, metres: the reach of the widest disc and that of the
/// search for its neighbours, and a column for those that hide them.
[[nodiscard]] inline double disc_reach_m(const DiscRule& rule) { return 3.0 * rule.widest() * disc_column_m(rule); }

/// Columns that hold all discs that may cover a node.
[[nodiscard]] BinLattice disc_columns(const BinLattice& nodes, const DiscRule& rule);

/// What a column takes while discs are found, bytes.
inline constexpr std::uint64_t kColumnBytes = 18;

/// Discs sorted into columns. The arrays may be read beyond their ends as those of Bins.
struct TangentDiscs {
  BinLattice columns;
  BinWindow window;                 ///< the columns that are there
  Buffer<std::uint32_t> start;      ///< bins_x() + 1 values per row; those of the window's rows are set
  Buffer<float> x, y;               ///< feet, metres relative to the oriented points' origin
  Buffer<float> slope_x, slope_y;   ///< dz/dx, dz/dy
  Buffer<float> radius2;            ///< of the disc, m^2
  Buffer<float> records;            ///< kDiscRecord values each: all that is known of it
  std::vector<std::uint8_t> rings;  ///< of each column: how many to each side hold discs that reach its nodes

  [[nodiscard]] float height(std::size_t disc) const { return records[kDiscRecord * disc + 2]; }
  [[nodiscard]] float& facing(std::size_t disc) { return records[kDiscRecord * disc + 7]; }
};

/// The discs of points that are not hidden for certain; with `all`, of every point. `skip` as for sort_into_bins.
/// Memory comes from `store` when it is given.
[[nodiscard]] TangentDiscs find_discs(const OrientedPoints& points, const std::vector<std::uint8_t>& skip,
                                      const BinLattice& columns, const BinWindow& window, const DiscRule& rule,
                                      bool all, ThreadPool& pool, MemoryStore* store = nullptr);

/// Discs that are given as records (kDiscRecord values each) in columns, in the order in which they are given. Those
/// beyond the columns are left out.
[[nodiscard]] TangentDiscs arrange_discs(std::span<const float> records, const BinLattice& columns,
                                         const DiscRule& rule);

/// What decides about nodes by discs; its scratch memory is to be set. Heights of discs are one layer within `noise_m`;
/// `lines` as in DiscRule. Reads the discs, which must outlive it.
[[nodiscard]] DiscNodeKernel node_kernel(const TangentDiscs& discs, const BinLattice& nodes, double noise_m,
                                         bool lines);

}  // namespace sparsha::pipeline
