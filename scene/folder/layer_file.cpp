// Layers as tiled TIFF files, in and out.
#include "scene/folder/layer_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "scene/folder/tiff_file.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

Error write_error(const std::filesystem::path& file, const std::string& message) {
  return {ErrorKind::failure,
          {file.string(), 0, 0},
          "cannot write the layer" + (message.empty() ? "" : ": " + message),
          "a disk with room"};
}

struct PixelFormat {
  std::uint16_t bits = 32;
  std::uint16_t samples = 1;
  bool floating = true;
  [[nodiscard]] std::size_t bytes() const { return std::size_t{bits} / 8 * samples; }
};

// Writes tiles whose pixels `convert(source index, destination)` fills.
template <typename Convert>
void write_tiles(const std::filesystem::path& file, int nx, int ny, const PixelFormat& format, const Convert& convert) {
  TiffLayout layout;
  layout.width = static_cast<std::uint32_t>(nx);
  layout.height = static_cast<std::uint32_t>(ny);
  layout.tile = kTileSize;
  layout.bits = format.bits;
  layout.samples = format.samples;
  layout.floating = format.floating;
  TiffFile tiff = TiffFile::create(file, layout);
  if (!tiff.is_open()) throw write_error(file, tiff.message());

  const std::size_t pixel = format.bytes();
  std::vector<unsigned char> tile(pixel * kTileSize * kTileSize);
  for (std::uint32_t top = 0; top < layout.height; top += kTileSize) {
    for (std::uint32_t left = 0; left < layout.width; left += kTileSize) {
      // Pixels beyond the edge repeat the last one: no uninitialised bytes, and compressible by others.
      for (std::uint32_t row = 0; row < kTileSize; ++row) {
        const int j = ny - 1 - static_cast<int>(std::min(top + row, layout.height - 1));
        unsigned char* out = tile.data() + pixel * kTileSize * row;
        const std::size_t line = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        const std::uint32_t inside = std::min(kTileSize, layout.width - left);
        convert(line + left, inside, out);
        for (std::uint32_t column = inside; column < kTileSize; ++column) {
          std::memcpy(out + pixel * column, out + pixel * (inside - 1), pixel);
        }
      }
      if (!tiff.write_tile(left, top, tile.data())) throw write_error(file, tiff.message());
    }
  }
  if (!tiff.flush()) throw write_error(file, tiff.message());
}

template <typename Value>
void write_plain(const std::filesystem::path& file, int nx, int ny, const PixelFormat& format,
                 std::span<const Value> values) {
  write_tiles(file, nx, ny, format, [&](std::size_t source, std::uint32_t count, unsigned char* out) {
    std::memcpy(out, values.data() + source, count * sizeof(Value));
  });
}

// Opens a layer and checks that it is what scene.yaml says.
TiffFile open_layer(const std::filesystem::path& file, const LayerRegion& region, PixelFormat& format) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) throw input_error(file.string(), "the layer is missing");
  TiffFile tiff = TiffFile::open(file);
  if (!tiff.is_open()) throw input_error(file.string(), "not a readable TIFF: " + tiff.message(), "a layer of a scene");
  const TiffLayout found = tiff.layout();
  const bool wide_float = format.floating && found.bits == 64;
  if (found.width != static_cast<std::uint32_t>(region.level_nx) ||
      found.height != static_cast<std::uint32_t>(region.level_ny) || found.tile != kTileSize ||
      found.samples != format.samples || found.floating != format.floating ||
      (found.bits != format.bits && !wide_float)) {
    throw input_error(file.string(),
                      fmt::format("the layer has {}x{} pixels of {}x{} bits in tiles of {}", found.width, found.height,
                                  found.samples, found.bits, found.tile),
                      fmt::format("{}x{} pixels of {}x{} bits in tiles of {}", region.level_nx, region.level_ny,
                                  format.samples, format.bits, kTileSize));
  }
  format.bits = found.bits;
  // Before memory is taken for what the file only claims: plain pixels are all there, packed ones cannot be packed
  // closer than deflate packs zeros.
  const double closest = found.packed ? 1032.0 : 1.0;
  const double pixels = static_cast<double>(found.width) * found.height * static_cast<double>(format.bytes());
  const auto bytes = static_cast<double>(std::filesystem::file_size(file, code));
  if (code || bytes * closest < pixels) {
    throw input_error(file.string(),
                      fmt::format("the layer's {}x{} pixels are not in its {} bytes", found.width, found.height, bytes),
                      "an undamaged layer");
  }
  return tiff;
}

template <typename Value, typename Convert>
void read_tiles(const std::filesystem::path& file, const LayerRegion& region, PixelFormat format,
                std::span<Value> values, const Convert& convert) {
  TiffFile tiff = open_layer(file, region, format);
  const std::size_t pixel = format.bytes();
  const int i_begin = std::max(region.i0, 0);
  const int i_end = std::min(region.i0 + region.nx, region.level_nx);
  const int row_begin = std::max(region.level_ny - (region.j0 + region.ny), 0);  // file rows, top first
  const int row_end = std::min(region.level_ny - region.j0, region.level_ny);
  if (i_begin >= i_end || row_begin >= row_end) return;
  constexpr int kTile = static_cast<int>(kTileSize);
  std::vector<unsigned char> tile(pixel * kTileSize * kTileSize);
  for (int top = row_begin / kTile * kTile; top < row_end; top += kTile) {
    for (int left = i_begin / kTile * kTile; left < i_end; left += kTile) {
      if (!tiff.read_tile(static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(top), tile.data())) {
        throw input_error(file.string(), "a tile cannot be read: " + tiff.message(), "an undamaged layer");
      }
      for (int row = std::max(top, row_begin); row < std::min(top + kTile, row_end); ++row) {
        const int j = region.level_ny - 1 - row;
        const int from = std::max(left, i_begin);
        const int to = std::min(left + kTile, i_end);
        const std::size_t target = static_cast<std::size_t>(j - region.j0) * static_cast<std::size_t>(region.nx) +
                                   static_cast<std::size_t>(from - region.i0);
        const unsigned char* in = tile.data() + pixel * static_cast<std::size_t>((row - top) * kTile + (from - left));
        convert(in, static_cast<std::size_t>(to - from), format, values.data() + target);
      }
    }
  }
}

constexpr PixelFormat kByte{8, 1, false};
constexpr PixelFormat kRgba{8, 4, false};

}  // namespace

void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const float> values) {
  constexpr float kFar_m = 1000.0F;  // beyond which float32 would leave less than 0.1 mm
  const bool wide = std::any_of(values.begin(), values.end(), [](float v) { return std::abs(v) > kFar_m; });
  if (!wide) return write_plain(file, nx, ny, PixelFormat{}, values);
  write_tiles(file, nx, ny, PixelFormat{64, 1, true}, [&](std::size_t source, std::uint32_t count, unsigned char* out) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const double value = static_cast<double>(values[source + i]);
      std::memcpy(out + 8 * i, &value, 8);
    }
  });
}

void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const std::uint8_t> values) {
  write_plain(file, nx, ny, kByte, values);
}

void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const std::uint32_t> pixels) {
  write_plain(file, nx, ny, kRgba, pixels);
}

void check_layer(const std::filesystem::path& file, int level_nx, int level_ny, LayerKind kind) {
  PixelFormat format = kind == LayerKind::byte ? kByte : kind == LayerKind::rgba ? kRgba : PixelFormat{};
  static_cast<void>(open_layer(file, {level_nx, level_ny}, format));
}

void read_layer(const std::filesystem::path& file, const LayerRegion& region, std::span<float> values) {
  read_tiles(file, region, PixelFormat{}, values,
             [](const unsigned char* in, std::size_t count, const PixelFormat& format, float* out) {
               if (format.bits == 32) {
                 std::memcpy(out, in, count * 4);
                 return;
               }
               for (std::size_t i = 0; i < count; ++i) {
                 double value = 0.0;
                 std::memcpy(&value, in + 8 * i, 8);
                 out[i] = static_cast<float>(value);
               }
             });
}

void read_layer(const std::filesystem::path& file, const LayerRegion& region, std::span<std::uint8_t> values) {
  read_tiles(file, region, kByte, values,
             [](const unsigned char* in, std::size_t count, const PixelFormat&, std::uint8_t* out) {
               std::memcpy(out, in, count);
             });
}

void read_layer(const std::filesystem::path& file, const LayerRegion& region, std::span<std::uint32_t> pixels) {
  read_tiles(file, region, kRgba, pixels,
             [](const unsigned char* in, std::size_t count, const PixelFormat&, std::uint32_t* out) {
               std::memcpy(out, in, count * 4);
             });
}

bool keeps_scan_axes(const SceneDescription& scene) {
  if (scene.config.unroll) return false;
  const Eigen::Matrix4d& scan_from_grid = scene.scan_from_grid;
  const double scale = scan_from_grid(0, 0);
  const double slack = 1e-12 * std::abs(scale);
  return scale > 0.0 && std::abs(scan_from_grid(1, 1) - scale) <= slack && std::abs(scan_from_grid(0, 1)) <= slack &&
         std::abs(scan_from_grid(1, 0)) <= slack && std::abs(scan_from_grid(0, 2)) <= slack &&
         std::abs(scan_from_grid(1, 2)) <= slack;
}

RasterPlace raster_place(const Lattice& lattice, const SceneDescription& scene) {
  const Eigen::Matrix4d& scan_from_grid = scene.scan_from_grid;
  RasterPlace place{lattice.x_m(0), lattice.y_m(lattice.ny - 1), lattice.spacing_m};
  if (keeps_scan_axes(scene)) {
    const double scale = scan_from_grid(0, 0);
    place = {scale * place.x + scan_from_grid(0, 3), scale * place.y + scan_from_grid(1, 3), scale * place.step};
  }
  return place;
}

std::string world_file(const Lattice& lattice, const SceneDescription& scene) {
  const RasterPlace place = raster_place(lattice, scene);
  return fmt::format("{:.12g}\n0\n0\n{:.12g}\n{:.17g}\n{:.17g}\n", place.step, -place.step, place.x, place.y);
}

}  // namespace sparsha::scene
