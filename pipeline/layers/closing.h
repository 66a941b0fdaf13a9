// Morphology of node sets by discs, on packed bits: the closing that says which gaps are filled, and the outline.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// One bit per node, rows packed into 64-bit words; bits beyond nx are zero.
class NodeSet {
 public:
  NodeSet(int nx, int ny);

  [[nodiscard]] int nx() const { return nx_; }
  [[nodiscard]] int ny() const { return ny_; }
  [[nodiscard]] std::size_t words_per_row() const { return words_; }
  [[nodiscard]] std::uint64_t* row(int j) { return bits_.data() + static_cast<std::size_t>(j) * words_; }
  [[nodiscard]] const std::uint64_t* row(int j) const { return bits_.data() + static_cast<std::size_t>(j) * words_; }
  [[nodiscard]] bool contains(int i, int j) const { return ((row(j)[i >> 6] >> (i & 63)) & 1U) != 0; }
  void insert(int i, int j) { row(j)[i >> 6] |= std::uint64_t{1} << (i & 63); }
  /// Calls body(i) for the nodes of a row among [first, end), from left to right; 0 <= first, end <= nx.
  template <typename Body>
  void for_each_in_row(int j, int first, int end, const Body& body) const {
    if (first >= end) return;
    const std::uint64_t* const words = row(j);
    const int last = (end - 1) >> 6;
    for (int k = first >> 6; k <= last; ++k) {
      std::uint64_t left = words[k];
      if (k == first >> 6) left &= ~std::uint64_t{0} << (first & 63);
      if (k == last) left &= ~std::uint64_t{0} >> (63 - ((end - 1) & 63));
      for (; left != 0; left &= left - 1) body(64 * k + std::countr_zero(left));
    }
  }
  /// Complement within nx x ny.
  void invert();
  [[nodiscard]] std::size_t count() const;

 private:
  int nx_, ny_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

/// Nodes whose state is `state`.
[[nodiscard]] NodeSet nodes_of(const scene::DepthGrid& grid, scene::NodeState state);

/// Nodes within `radius` (in spacings, inclusive) of a node of `set`. Time grows with nodes * radius / 64.
[[nodiscard]] NodeSet dilate_by_disc(const NodeSet& set, double radius, ThreadPool& pool);

/// Closing by a disc of `diameter` (in spacings), as if the lattice went on empty beyond its border: a node belongs to
/// it when no disc free of `set` and centred on a node covers it.
[[nodiscard]] NodeSet close_by_disc(const NodeSet& set, double diameter, ThreadPool& pool);

/// Everything that the outer border of `set` encloses: `set` and its holes. Paths outside go along rows and columns.
/// Memory beside the result grows with the runs of nodes outside, not with their number.
[[nodiscard]] NodeSet fill_holes(const NodeSet& set);

/// Diameter of the disc that closes the measured nodes for their outline, spacings.
[[nodiscard]] double outline_diameter(const scene::Lattice& lattice, double max_gap_m);
/// Nodes inside the outline: outer border of the measured nodes closed by that disc, of max(max_gap_m, 3 spacings).
[[nodiscard]] NodeSet outline_nodes(const scene::DepthGrid& grid, double max_gap_m, ThreadPool& pool);

}  // namespace sparsha::pipeline
