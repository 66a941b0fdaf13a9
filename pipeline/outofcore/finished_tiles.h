// Tiles that a build has measured, kept in a file until the scene is whole: a build that was ended goes on from them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "pipeline/outofcore/tiles.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// What was measured in a tile; nodes row by row.
struct TileNodes {
  std::uint64_t scattered = 0;  ///< points of no surface
  std::vector<float> height_m;
  std::vector<scene::NodeState> state;
  std::vector<std::uint8_t> verdicts;  ///< empty but where discs decide the nodes
};

/// Of a tile in a whole grid; `verdicts` has one a node of the grid, or none at all.
[[nodiscard]] TileNodes take_nodes(const Tile& tile, const scene::DepthGrid& grid,
                                   const std::vector<std::uint8_t>& verdicts);
void put_nodes(const Tile& tile, const TileNodes& nodes, scene::DepthGrid& grid, std::vector<std::uint8_t>& verdicts);

/// The file begins with a line that names its format and the key; then tile by tile the four borders, the number of
/// scattered points, the size of the verdicts, heights, states, verdicts and a SHA-256 of the key and all that, as this
/// machine has numbers in memory.
class FinishedTiles {
 public:
  /// Opens the file, or makes it; what it holds of another `key` (one line: whatever decides the tiles' bytes) is left
  /// out, and so is a tile that was being written. Throws Error{failure} when it cannot be written.
  FinishedTiles(std::filesystem::path file, std::string key);

  /// Whether the file held tiles of another key.
  [[nodiscard]] bool was_of_another() const { return was_of_another_; }
  /// How many tiles it held.
  [[nodiscard]] std::size_t found() const { return places_.size(); }

  /// False when there is no such tile, or it is damaged.
  [[nodiscard]] bool take(const Tile& tile, TileNodes& nodes);
  /// Throws Error{failure} when the disk is full.
  void add(const Tile& tile, const TileNodes& nodes);

 private:
  using Borders = std::array<std::int32_t, 4>;
  [[nodiscard]] static Borders borders_of(const Tile& tile);
  [[nodiscard]] std::uint64_t find_tiles(std::uint64_t begin, std::uint64_t size);

  std::filesystem::path file_;
  std::string key_;
  std::map<Borders, std::uint64_t> places_;  ///< of tiles in the file
  bool was_of_another_ = false;
  std::fstream stream_;
};

/// Removes a file of finished tiles, of whichever build; any other file, a folder or a link stays.
void remove_finished_tiles(const std::filesystem::path& file);

}  // namespace sparsha::pipeline
