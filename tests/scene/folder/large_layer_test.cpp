// Layers of more than 2^32 nodes: what lies at their far end is read from there. The file is sparse, and so takes no
// room.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <vector>

#include "scene/folder/layer_file.h"
#include "scene/folder/tiff_file.h"
#include "tests/support/test_folder.h"

namespace sparsha::scene {
namespace {

TEST(LargeLayer, ItsFarEndIsReadFromWhereItLies) {
  constexpr std::uint32_t kSide = 70'000;  // 4.9 * 10^9 nodes
  constexpr std::uint32_t kLastTile = (kSide - 1) / kTileSize * kTileSize;
  const test::TestFolder folder;
  const std::filesystem::path file = folder / "mask.tif";
  const auto value = [](std::uint32_t left, std::uint32_t top, std::size_t k) {
    return static_cast<std::uint8_t>((left + 3 * top) / kTileSize + k * 7 + k / kTileSize);
  };
  {
    TiffFile tiff = TiffFile::create(file, {kSide, kSide, kTileSize, 8, 1, false, false});
    ASSERT_TRUE(tiff.is_open());
    for (const auto& [left, top] :
         {std::pair<std::uint32_t, std::uint32_t>{0, 0}, {kLastTile, 0}, {0, kLastTile}, {kLastTile, kLastTile}}) {
      std::vector<std::uint8_t> tile(std::size_t{kTileSize} * kTileSize);
      for (std::size_t k = 0; k < tile.size(); ++k) tile[k] = value(left, top, k);
      ASSERT_TRUE(tiff.write_tile(left, top, tile.data())) << tiff.message();
    }
    ASSERT_TRUE(tiff.flush()) << tiff.message();
  }
  std::filesystem::resize_file(file, std::uint64_t{kSide} * kSide + (std::uint64_t{1} << 24U));
  constexpr int kLevel = static_cast<int>(kSide);
  for (const auto& [left, top] :
       {std::pair<std::uint32_t, std::uint32_t>{0, 0}, {kLastTile, 0}, {0, kLastTile}, {kLastTile, kLastTile}}) {
    constexpr int kWindow = 40;
    const int i0 = static_cast<int>(left) + 3;
    const int row0 = static_cast<int>(top) + 5;  // of the file, top first
    std::vector<std::uint8_t> window(std::size_t{kWindow} * kWindow);
    read_layer(file, {kLevel, kLevel, i0, kLevel - row0 - kWindow, kWindow, kWindow}, std::span<std::uint8_t>(window));
    for (int j = 0; j < kWindow; ++j)
      for (int i = 0; i < kWindow; ++i) {
        const auto row = static_cast<std::size_t>(5 + kWindow - 1 - j);
        ASSERT_EQ(window[static_cast<std::size_t>(j * kWindow + i)],
                  value(left, top, row * kTileSize + 3 + static_cast<std::size_t>(i)))
            << left << " " << top << ": " << i << " " << j;
      }
  }
}

TEST(LargeLattice, CountsAndNumbersItsNodesWith64Bits) {
  Lattice lattice;
  lattice.nx = 100'000;
  lattice.ny = 1 << 24U;
  EXPECT_EQ(lattice.count(), 1'677'721'600'000U);
  EXPECT_EQ(lattice.index(99'999, (1 << 24) - 1), lattice.count() - 1);
  EXPECT_EQ(lattice.index(1, 42'950), 4'295'000'001U);
}

}  // namespace
}  // namespace sparsha::scene
