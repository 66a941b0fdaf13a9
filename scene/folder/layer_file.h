// One layer of one level as a tiled TIFF: file row 0 is the top row (j = ny-1). Uncompressed, so that a window costs
// its tiles and the same layer gives the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

inline constexpr std::uint32_t kTileSize = 256;  ///< nodes per side of a tile

/// Writes values in memory order (row 0 at the bottom). Floats carry GDAL_NODATA "nan" and become 64-bit when some
/// magnitude exceeds 1 km; BigTIFF beyond 4 GB. Throws Error{failure}.
void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const float> values);
void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const std::uint8_t> values);
/// 0xAABBGGRR pixels as 8-bit RGBA.
void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const std::uint32_t> pixels);

/// What a node of a layer is.
enum class LayerKind { number, byte, rgba };
/// Throws as read_layer() does when the file is not such a layer; reads no node.
void check_layer(const std::filesystem::path& file, int level_nx, int level_ny, LayerKind kind);

/// Reads nodes [i0, i0+nx) x [j0, j0+ny) into `values` (memory order); nodes outside the layer keep their value. Throws
/// Error{input} when the file is not such a layer of `level_nx` x `level_ny` nodes or a tile cannot be read.
struct LayerRegion {
  int level_nx = 0, level_ny = 0;
  int i0 = 0, j0 = 0, nx = 0, ny = 0;
};
void read_layer(const std::filesystem::path& file, const LayerRegion& region, std::span<float> values);
void read_layer(const std::filesystem::path& file, const LayerRegion& region, std::span<std::uint8_t> values);
void read_layer(const std::filesystem::path& file, const LayerRegion& region, std::span<std::uint32_t> pixels);

/// Where the picture of a level lies: the centre of the top-left pixel = node (0, ny-1), and the distance of nodes. In
/// the scan frame when x and y stay the scan's axes, else in the grid frame.
struct RasterPlace {
  double x = 0.0, y = 0.0, step = 0.0;
};
[[nodiscard]] RasterPlace raster_place(const Lattice& lattice, const SceneDescription& scene);
/// The six lines of a world file for `lattice`: A, D, B, E, C, F with C, F as raster_place() and E < 0.
[[nodiscard]] std::string world_file(const Lattice& lattice, const SceneDescription& scene);
/// True when grid x and y point along scan x and y with one positive scale; never of an unrolled scene.
[[nodiscard]] bool keeps_scan_axes(const SceneDescription& scene);

}  // namespace sparsha::scene
