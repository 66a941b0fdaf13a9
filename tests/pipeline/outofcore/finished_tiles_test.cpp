// Tiles that are kept: whatever happens to the file, a tile is either what was measured or not there.
#include "pipeline/outofcore/finished_tiles.h"

#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "base/files/files.h"
#include "tests/support/test_folder.h"

namespace sparsha::pipeline {
namespace {

Tile tile_of(int first_row, int last_row, int first_column, int last_column) {
  Tile tile;
  tile.first_row = first_row;
  tile.last_row = last_row;
  tile.first_column = first_column;
  tile.last_column = last_column;
  return tile;
}

const std::vector<Tile>& tiles() {
  static const std::vector<Tile> kTiles{tile_of(0, 3, 0, 9), tile_of(3, 7, 0, 4), tile_of(3, 7, 4, 9)};
  return kTiles;
}

TileNodes nodes_of(const Tile& tile, unsigned seed, bool verdicts) {
  std::mt19937 random(seed);
  TileNodes nodes;
  nodes.scattered = random();
  const int count = (tile.last_row - tile.first_row) * (tile.last_column - tile.first_column);
  for (int k = 0; k < count; ++k) {
    nodes.height_m.push_back(static_cast<float>(random()));
    nodes.state.push_back(static_cast<scene::NodeState>(random() % 3));
    if (verdicts) nodes.verdicts.push_back(static_cast<std::uint8_t>(random()));
  }
  return nodes;
}

bool same(const TileNodes& a, const TileNodes& b) {
  return a.scattered == b.scattered && a.height_m == b.height_m && a.state == b.state && a.verdicts == b.verdicts;
}

class Finished : public ::testing::Test {
 protected:
  static constexpr std::size_t kLargest = 1U << 20U;

  void write(bool verdicts = false) {
    FinishedTiles finished(file_, "key");
    for (unsigned k = 0; k < tiles().size(); ++k) finished.add(tiles()[k], nodes_of(tiles()[k], k, verdicts));
  }
  /// Numbers of the tiles that are there; all of them must be what was measured.
  std::size_t there(bool verdicts = false) {
    FinishedTiles finished(file_, "key");
    std::size_t count = 0;
    for (unsigned k = 0; k < tiles().size(); ++k) {
      TileNodes nodes;
      if (!finished.take(tiles()[k], nodes)) continue;
      ++count;
      EXPECT_TRUE(same(nodes, nodes_of(tiles()[k], k, verdicts))) << "tile " << k;
    }
    return count;
  }

  const test::TestFolder folder_;
  const std::filesystem::path file_ = folder_ / "tiles";
};

TEST_F(Finished, TilesAreThoseThatWereAddedInWhateverOrderTheyAreTaken) {
  for (const bool verdicts : {false, true}) {
    write(verdicts);
    EXPECT_EQ(there(verdicts), 3U);
    FinishedTiles finished(file_, "key");
    EXPECT_FALSE(finished.was_of_another());
    EXPECT_EQ(finished.found(), 3U);
    TileNodes nodes;
    EXPECT_FALSE(finished.take(tile_of(3, 7, 0, 5), nodes)) << "a tile of other borders";
    std::filesystem::remove(file_);
  }
}

TEST_F(Finished, TilesOfAnotherKeyAreLeftOutAndTheFileBeginsAnew) {
  write();
  {
    FinishedTiles finished(file_, "yek");
    EXPECT_TRUE(finished.was_of_another());
    EXPECT_EQ(finished.found(), 0U);
    finished.add(tiles()[1], nodes_of(tiles()[1], 7, false));
  }
  FinishedTiles finished(file_, "yek");
  EXPECT_FALSE(finished.was_of_another());
  EXPECT_EQ(finished.found(), 1U);
}

TEST_F(Finished, AFileCutAnywhereHoldsTheTilesBeforeTheCutAndIsAddedToBehindThem) {
  write();
  const std::string whole = read_file(file_, kLargest);
  std::size_t most = 0;
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    write_file(file_, whole.substr(0, length));
    const std::size_t kept = there();
    EXPECT_GE(kept, most);
    EXPECT_LT(kept, 3U);
    most = std::max(most, kept);
    {
      FinishedTiles finished(file_, "key");
      for (std::size_t k = kept; k < tiles().size(); ++k)
        finished.add(tiles()[k], nodes_of(tiles()[k], static_cast<unsigned>(k), false));
    }
    EXPECT_EQ(there(), 3U) << "cut at " << length;
    EXPECT_EQ(read_file(file_, kLargest), whole);
  }
  EXPECT_EQ(most, 2U);
}

TEST_F(Finished, ADamagedTileIsNotThere) {
  write();
  const std::string whole = read_file(file_, kLargest);
  const std::size_t heads = whole.find('\n') + 1;
  for (std::size_t at = heads; at < whole.size(); at += 3) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_file(file_, damaged);
    EXPECT_LT(there(), 3U) << "byte " << at;
  }
}

TEST_F(Finished, WhatIsNoFileIsRefused) {
  std::filesystem::create_directory(file_);
  EXPECT_THROW(FinishedTiles(file_, "key"), Error);
  EXPECT_THROW(FinishedTiles(folder_ / "missing" / "tiles", "key"), Error);
  const std::filesystem::path other = folder_ / "other";
  write_file(other, "precious");
  std::filesystem::create_symlink(other, folder_ / "link");
  EXPECT_THROW(FinishedTiles(folder_ / "link", "key"), Error);
  EXPECT_EQ(read_file(other, kLargest), "precious");
}

TEST(TileNodesOfAGrid, AreItsRowsAndGoBackWhereTheyWere) {
  scene::Lattice lattice;
  lattice.nx = 9;
  lattice.ny = 7;
  scene::DepthGrid grid(lattice);
  std::vector<std::uint8_t> verdicts(lattice.count());
  std::mt19937 random(3);
  for (std::size_t n = 0; n < lattice.count(); ++n) {
    grid.height_m[n] = static_cast<float>(random());
    grid.state[n] = static_cast<scene::NodeState>(random() % 3);
    verdicts[n] = static_cast<std::uint8_t>(random());
  }
  scene::DepthGrid other(lattice);
  std::vector<std::uint8_t> other_verdicts(lattice.count());
  for (const Tile& tile : tiles()) put_nodes(tile, take_nodes(tile, grid, verdicts), other, other_verdicts);
  EXPECT_EQ(other.height_m, grid.height_m);
  EXPECT_EQ(other.state, grid.state);
  EXPECT_EQ(other_verdicts, verdicts);
}

TEST_F(Finished, TilesAreRemovedAndNothingElse) {
  write();
  remove_finished_tiles(file_);
  EXPECT_FALSE(std::filesystem::exists(file_));
  remove_finished_tiles(file_);
  for (const char* text : {"", "sparsha", "sparsha cloud 1 of somebody"}) {
    write_file(file_, text);
    remove_finished_tiles(file_);
    EXPECT_EQ(read_file(file_, kLargest), text);
  }
  std::filesystem::remove(file_);
  std::filesystem::create_directory(file_);
  remove_finished_tiles(file_);
  EXPECT_TRUE(std::filesystem::is_directory(file_));
  std::filesystem::remove(file_);
  const std::filesystem::path other = folder_ / "other";
  FinishedTiles(other, "key");
  std::filesystem::create_symlink(other, file_);
  remove_finished_tiles(file_);
  EXPECT_TRUE(std::filesystem::is_symlink(file_) && std::filesystem::exists(other));
}

}  // namespace
}  // namespace sparsha::pipeline
