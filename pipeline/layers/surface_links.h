// Which neighbouring nodes of a depth grid lie on one layer of the surface, and which nodes about a node belong to its
// own layer.
//
//        |  up(i,j)      a link is cut where a node is unknown and across a step: a jump that the surface continues
//   -----o-----          on neither side
//        |  right(i,j)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// What tells a step from slope and noise.
struct StepRule {
  double noise_m = 0.0;  ///< white noise of the heights, a node
  double step_m = 1e30;  ///< a jump beyond the surface's own continuation is a step from this height on, if not below
};

/// One bit per link; immutable. Links between the nodes of a lattice thinned by `stride` are whole where all links
/// between are.
class SurfaceLinks {
 public:
  SurfaceLinks(const scene::DepthGrid& grid, const StepRule& rule, ThreadPool& pool);
  /// Of every `stride`-th node, for each of the stride * stride lattices that this gives.
  [[nodiscard]] SurfaceLinks thinned(int stride) const;

  /// Links to the right of 64 nodes of row j, node i + k * stride in bit k: 1 where whole. Nodes beyond the lattice
  /// have none.
  [[nodiscard]] std::uint64_t right(int i, int j) const { return word(right_, i, j); }
  /// The same upwards, to row j + stride.
  [[nodiscard]] std::uint64_t up(int i, int j) const { return word(up_, i, j); }
  [[nodiscard]] int stride() const { return stride_; }

  /// Nodes of row j with fewer than their four links to a neighbour: node 64 w + k in bit k of the w-th word. Links
  /// over the lattice's border do not count. Of links that are not thinned.
  void loose_nodes(int j, std::vector<std::uint64_t>& words) const;

 private:
  SurfaceLinks() = default;
  [[nodiscard]] std::uint64_t word(const std::vector<std::uint64_t>& bits, int i, int j) const;

  int nx_ = 0, ny_ = 0, stride_ = 1;
  std::size_t phase_words_ = 0;  // of one of a row's `stride` interleaved rows, with a word of zeros on either side
  std::vector<std::uint64_t> right_, up_;
};

/// The nodes about a node that ways of whole links lead to, each way going outwards only: the far side of a step is not
/// reached round its end from beside it.
class LayerWindow {
 public:
  static constexpr int kMostRadius = 31;
  /// Nodes (i + s dx, j + s dy), |dx|, |dy| <= radius <= kMostRadius, s the links' stride.
  void find(const SurfaceLinks& links, int i, int j, int radius);
  /// Row dy: node dx in bit dx + radius.
  [[nodiscard]] std::uint64_t row(int dy) const { return rows_[static_cast<std::size_t>(dy + radius_)]; }
  [[nodiscard]] int count() const { return count_; }

 private:
  int radius_ = 0, count_ = 0;
  std::array<std::uint64_t, 2 * kMostRadius + 1> rows_{};
};

}  // namespace sparsha::pipeline
