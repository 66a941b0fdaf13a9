// How a lattice is cut into tiles whose points, halo included, fit into a given memory.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/projection/bins.h"

namespace sparsha::pipeline {

/// Nodes [first_row, last_row) x [first_column, last_column), and the bins that decide them.
struct Tile {
  int first_row = 0, last_row = 0, first_column = 0, last_column = 0;
  BinWindow bins;
  std::uint64_t points = 0;  ///< in those bins
};

/// Cuts the lattice into bands of rows, and bands that hold more than `most_points` even where they are low into
/// columns. Bands are at most `most_rows` nodes high, or four halos where that is more. `row_points` has how many
/// points lie in each row of bins, and each row takes memory of `per_row` points more, whatever its columns;
/// `column_points(first, last)` how many lie in each column of the bin rows [first, last). `halo` bins to each side
/// belong to a tile. Throws Error{failure} when the halo of a single node exceeds `most_points`.
[[nodiscard]] std::vector<Tile> cut_into_tiles(
    const BinLattice& lattice, int halo, std::uint64_t most_points, int most_rows, std::uint64_t per_row,
    const std::vector<std::uint64_t>& row_points,
    const std::function<std::vector<std::uint64_t>(int first, int last)>& column_points);

}  // namespace sparsha::pipeline
