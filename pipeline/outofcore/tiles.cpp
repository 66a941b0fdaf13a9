// Greedy cuts along one axis, then along the other where the first does not do.
#include "pipeline/outofcore/tiles.h"

#include <algorithm>
#include <optional>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

/// Nodes [first, last) along an axis, their bins with halo, and the points in those.
struct Range {
  int first, last, first_bin, last_bin;
  std::uint64_t points;
};

/// Points in bins [0, n) along an axis.
std::vector<std::uint64_t> running_sum(const std::vector<std::uint64_t>& counts) {
  std::vector<std::uint64_t> sum(counts.size() + 1, 0);
  for (std::size_t k = 0; k < counts.size(); ++k) sum[k + 1] = sum[k] + counts[k];
  return sum;
}

class Axis {
 public:
  Axis(const std::vector<std::uint64_t>& bin_points, int nodes, int halo)
      : sum_(running_sum(bin_points)), nodes_(nodes), halo_(halo) {}

  [[nodiscard]] Range range(int first, int last) const {
    const int bins = static_cast<int>(sum_.size()) - 1;
    const int low = std::max(0, first + BinLattice::kMargin - halo_);
    const int high = std::min(bins, last + BinLattice::kMargin + halo_);
    return {first, last, low, high, sum_[static_cast<std::size_t>(high)] - sum_[static_cast<std::size_t>(low)]};
  }
  /// The longest range of at most so many nodes from `first` on with at most that many points; nothing when one node
  /// has more.
  [[nodiscard]] std::optional<Range> longest(int first, std::uint64_t most_points, int most_nodes) const {
    int good = first;
    int bad = (nodes_ - first <= most_nodes ? nodes_ : first + most_nodes) + 1;
    while (bad - good > 1) {
      const int middle = good + (bad - good) / 2;
      (range(first, middle).points <= most_points ? good : bad) = middle;
    }
    if (good == first) return std::nullopt;
    return range(first, good);
  }

 private:
  std::vector<std::uint64_t> sum_;
  int nodes_, halo_;
};

/// Tiles of some rows, cut into columns; nothing when a single column has too many points.
std::optional<std::vector<Tile>> cut_columns(const BinLattice& lattice, int halo, std::uint64_t most_points,
                                             const Range& rows, const std::vector<std::uint64_t>& column_points) {
  const Axis columns(column_points, lattice.nx, halo);
  std::vector<Tile> tiles;
  for (int i = 0; i < lattice.nx;) {
    const std::optional<Range> range = columns.longest(i, most_points, lattice.nx);
    if (!range) return std::nullopt;
    tiles.push_back({rows.first, rows.last, range->first, range->last,
                     BinWindow{rows.first_bin, rows.last_bin, range->first_bin, range->last_bin}, range->points});
    i = range->last;
  }
  return tiles;
}

}  // namespace

std::vector<Tile> cut_into_tiles(const BinLattice& lattice, int halo, std::uint64_t most_points, int most_rows,
                                 std::uint64_t per_row, const std::vector<std::uint64_t>& row_points,
                                 const std::function<std::vector<std::uint64_t>(int first, int last)>& column_points) {
  const auto beside = [&](const Range& rows) {
    return per_row * static_cast<std::uint64_t>(rows.last_bin - rows.first_bin);
  };
  std::vector<std::uint64_t> row_memory = row_points;
  for (std::uint64_t& points : row_memory) points += per_row;
  const Axis rows(row_memory, lattice.ny, halo);
  // Lower bands would read more halo than nodes.
  const int least = 4 * halo;
  const int most = std::max({1, least, most_rows});
  std::vector<Tile> tiles;
  for (int j = 0; j < lattice.ny;) {
    const std::optional<Range> whole = rows.longest(j, most_points, most);
    if (whole && (whole->last - j >= least || whole->last == lattice.ny)) {
      tiles.push_back({whole->first, whole->last, 0, lattice.nx,
                       BinWindow{whole->first_bin, whole->last_bin, 0, lattice.bins_x()},
                       whole->points - beside(*whole)});
      j = whole->last;
      continue;
    }
    std::optional<std::vector<Tile>> cut;
    for (int height = std::min(least, lattice.ny - j); height > 0 && !cut; height /= 2) {
      const Range range = rows.range(j, j + height);
      if (beside(range) > most_points) continue;
      cut = cut_columns(lattice, halo, most_points - beside(range), range,
                        column_points(range.first_bin, range.last_bin));
    }
    if (!cut) {
      throw Error(ErrorKind::failure, {},
                  "the points about a single node of the grid, " +
                      std::to_string(rows.range(j, j + 1).points - beside(rows.range(j, j + 1))) +
                      " in its rows, do not fit the memory limit",
                  "a higher --memory, a finer grid or a voxel filter");
    }
    tiles.insert(tiles.end(), cut->begin(), cut->end());
    j = cut->back().last_row;
  }
  return tiles;
}

}  // namespace sparsha::pipeline
