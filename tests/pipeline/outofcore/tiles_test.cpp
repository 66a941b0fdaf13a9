// Tiles against the rule itself: every node once, its halo in its tile, no tile with more points than allowed.
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "pipeline/outofcore/tiles.h"

namespace sparsha::pipeline {
namespace {

/// Bins with their numbers of points.
struct Density {
  BinLattice lattice;
  std::vector<std::uint64_t> points;

  Density(int nx, int ny) {
    lattice.nx = nx;
    lattice.ny = ny;
    lattice.spacing_m = 1.0;
    points.assign(lattice.bin_count(), 0);
  }
  [[nodiscard]] std::uint64_t& at(int column, int row) {
    return points[static_cast<std::size_t>(row) * static_cast<std::size_t>(lattice.bins_x()) +
                  static_cast<std::size_t>(column)];
  }
  [[nodiscard]] std::vector<Tile> cut(int halo, std::uint64_t most, int most_rows = 1 << 30) {
    std::vector<std::uint64_t> rows(static_cast<std::size_t>(lattice.bins_y()), 0);
    for (int row = 0; row < lattice.bins_y(); ++row)
      for (int column = 0; column < lattice.bins_x(); ++column) rows[static_cast<std::size_t>(row)] += at(column, row);
    return cut_into_tiles(lattice, halo, most, most_rows, 0, rows, [&](int first, int last) {
      std::vector<std::uint64_t> columns(static_cast<std::size_t>(lattice.bins_x()), 0);
      for (int row = first; row < last; ++row)
        for (int column = 0; column < lattice.bins_x(); ++column)
          columns[static_cast<std::size_t>(column)] += at(column, row);
      return columns;
    });
  }
  void check(const std::vector<Tile>& tiles, int halo, std::uint64_t most) {
    std::vector<int> covered(static_cast<std::size_t>(lattice.nx) * static_cast<std::size_t>(lattice.ny), 0);
    for (const Tile& tile : tiles) {
      std::uint64_t held = 0;
      for (int row = tile.bins.first_row; row < tile.bins.last_row; ++row)
        for (int column = tile.bins.first_column; column < tile.bins.last_column; ++column) held += at(column, row);
      EXPECT_EQ(held, tile.points);
      EXPECT_LE(held, most);
      const int margin = BinLattice::kMargin;
      EXPECT_LE(tile.bins.first_row, std::max(0, tile.first_row + margin - halo));
      EXPECT_GE(tile.bins.last_row, std::min(lattice.bins_y(), tile.last_row + margin + halo));
      EXPECT_LE(tile.bins.first_column, std::max(0, tile.first_column + margin - halo));
      EXPECT_GE(tile.bins.last_column, std::min(lattice.bins_x(), tile.last_column + margin + halo));
      for (int j = tile.first_row; j < tile.last_row; ++j)
        for (int i = tile.first_column; i < tile.last_column; ++i)
          ++covered[static_cast<std::size_t>(j) * static_cast<std::size_t>(lattice.nx) + static_cast<std::size_t>(i)];
    }
    EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), static_cast<std::ptrdiff_t>(covered.size()));
  }
};

TEST(Tiles, CoverEveryNodeOnceWithItsHalo) {
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    Density density(static_cast<int>(1 + random() % 120), static_cast<int>(1 + random() % 120));
    for (std::uint64_t& count : density.points) count = random() % 9;
    const int halo = static_cast<int>(random() % 9);
    const std::uint64_t most = 9U * 400U + random() % 60000;  // the halo of a node holds at most 8 * 17 * 17
    density.check(density.cut(halo, most), halo, most);
  }
}

TEST(Tiles, AreBandsOfRowsWhereMemoryAllows) {
  Density density(100, 100);
  for (std::uint64_t& count : density.points) count = 4;
  EXPECT_EQ(density.cut(5, 100000).size(), 1U);
  for (const Tile& tile : density.cut(5, 20000)) EXPECT_EQ(tile.last_column - tile.first_column, 100);
}

TEST(Tiles, AreNoHigherThanAskedForUnlessTheirHalosAre) {
  Density density(60, 500);
  for (std::uint64_t& count : density.points) count = 1;
  for (const auto& [asked, height] : {std::pair{70, 70}, {3, 20}, {500, 500}}) {
    const std::vector<Tile> tiles = density.cut(5, 1'000'000, asked);
    density.check(tiles, 5, 1'000'000);
    for (const Tile& tile : tiles) EXPECT_LE(tile.last_row - tile.first_row, height);
    EXPECT_EQ(tiles.front().last_row, height);
  }
}

TEST(Tiles, OfGridsWithMoreThan32BitsOfNodesAndPointsCoverEachRowOnce) {
  BinLattice lattice;
  lattice.nx = lattice.ny = 100'000;  // 10^10 nodes
  lattice.spacing_m = 1.0;
  const std::vector<std::uint64_t> rows(static_cast<std::size_t>(lattice.bins_y()), 200'000);  // 2 * 10^10 points
  EXPECT_GT(lattice.bin_count(), 10'000'000'000U);
  EXPECT_EQ(lattice.bin(lattice.nx + BinLattice::kMargin - 1, lattice.ny + BinLattice::kMargin - 1),
            lattice.bin_count() - 1);
  constexpr std::uint64_t kMost = std::uint64_t{6} << 30U;
  const std::vector<Tile> tiles =
      cut_into_tiles(lattice, 5, kMost, lattice.ny, 0, rows, [](int, int) { return std::vector<std::uint64_t>(); });
  ASSERT_GT(tiles.size(), 1U);
  EXPECT_GT(tiles.front().points, std::uint64_t{1} << 32U);
  int row = 0;
  for (const Tile& tile : tiles) {
    EXPECT_EQ(tile.first_row, row);
    EXPECT_EQ(tile.points, 200'000U * static_cast<std::uint64_t>(tile.bins.last_row - tile.bins.first_row));
    row = tile.last_row;
  }
  EXPECT_EQ(row, lattice.ny);
}

TEST(Tiles, AnOverfullBandIsCutIntoColumns) {
  Density density(300, 300);
  for (int row = 100; row < 110; ++row)
    for (int column = 0; column < density.lattice.bins_x(); ++column) density.at(column, row) = 1000;
  const std::uint64_t most = 250000;
  const std::vector<Tile> tiles = density.cut(5, most);
  density.check(tiles, 5, most);
  EXPECT_TRUE(std::any_of(tiles.begin(), tiles.end(), [](const Tile& t) { return t.last_column < 300; }));
}

TEST(Tiles, TooManyPointsAboutOneNodeAreAClearError) {
  Density density(50, 50);
  density.at(25, 25) = 1000;
  try {
    (void)density.cut(5, 999);
    FAIL() << "1000 points in one bin cannot be cut";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failure);
    EXPECT_NE(error.wrong().find("a single node"), std::string::npos);
  }
}

}  // namespace
}  // namespace sparsha::pipeline
