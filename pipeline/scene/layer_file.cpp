// Tiled TIFF in and out through libtiff, with its messages turned into errors.
#include "pipeline/scene/layer_file.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>

#include "pipeline/base/error.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kGdalNodata = 42113;
thread_local std::string tiff_message;  // the last complaint of libtiff on this thread

void keep_message(const char*, const char* format, va_list arguments) {
  std::array<char, 300> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  tiff_message = text.data();
}

TIFFExtendProc parent_extender = nullptr;

void register_nodata(TIFF* tiff) {
  static char name[] = "GDALNoDataValue";
  static const TIFFFieldInfo field[] = {{kGdalNodata, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, name}};
  TIFFMergeFieldInfo(tiff, field, 1);
  if (parent_extender != nullptr) parent_extender(tiff);
}

void prepare_library() {
  static std::once_flag once;
  std::call_once(once, [] {
    parent_extender = TIFFSetTagExtender(register_nodata);
    TIFFSetErrorHandler(keep_message);
    TIFFSetWarningHandler(nullptr);
  });
  tiff_message.clear();
}

struct Closer {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffPointer = std::unique_ptr<TIFF, Closer>;

Error write_error(const std::filesystem::path& file) {
  return {ErrorKind::failure,
          {file.string(), 0, 0},
          "cannot write the layer" + (tiff_message.empty() ? "" : ": " + tiff_message),
          "a disk with room"};
}

struct PixelFormat {
  std::uint16_t bits = 32;
  std::uint16_t samples = 1;
  std::uint16_t sample_format = SAMPLEFORMAT_IEEEFP;
  [[nodiscard]] std::size_t bytes() const { return std::size_t{bits} / 8 * samples; }
};

// Writes `count` tiles whose pixels `convert(source index, destination)` fills.
template <typename Convert>
void write_tiles(const std::filesystem::path& file, int nx, int ny, const PixelFormat& format, const Convert& convert) {
  prepare_library();
  const double bytes = static_cast<double>(nx) * ny * static_cast<double>(format.bytes());
  const TiffPointer tiff(TIFFOpen(file.c_str(), bytes > 3.9e9 ? "w8" : "w"));
  if (!tiff) throw write_error(file);
  TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(nx));
  TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(ny));
  TIFFSetField(tiff.get(), TIFFTAG_TILEWIDTH, kTileSize);
  TIFFSetField(tiff.get(), TIFFTAG_TILELENGTH, kTileSize);
  TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, format.bits);
  TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, format.samples);
  TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, format.sample_format);
  TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, format.samples == 4 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  if (format.samples == 4) {
    const std::uint16_t extra = EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff.get(), TIFFTAG_EXTRASAMPLES, 1, &extra);
  }
  if (format.sample_format == SAMPLEFORMAT_IEEEFP) TIFFSetField(tiff.get(), kGdalNodata, "nan");

  const std::size_t pixel = format.bytes();
  std::vector<unsigned char> tile(pixel * kTileSize * kTileSize);
  for (std::uint32_t top = 0; top < static_cast<std::uint32_t>(ny); top += kTileSize) {
    for (std::uint32_t left = 0; left < static_cast<std::uint32_t>(nx); left += kTileSize) {
      // Pixels beyond the edge repeat the last one: no uninitialised bytes, and compressible by others.
      for (std::uint32_t row = 0; row < kTileSize; ++row) {
        const int j = ny - 1 - static_cast<int>(std::min(top + row, static_cast<std::uint32_t>(ny) - 1));
        unsigned char* out = tile.data() + pixel * kTileSize * row;
        const std::size_t line = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        const std::uint32_t inside = std::min(kTileSize, static_cast<std::uint32_t>(nx) - left);
        convert(line + left, inside, out);
        for (std::uint32_t column = inside; column < kTileSize; ++column) {
          std::memcpy(out + pixel * column, out + pixel * (inside - 1), pixel);
        }
      }
      if (TIFFWriteTile(tiff.get(), tile.data(), left, top, 0, 0) < 0) throw write_error(file);
    }
  }
  if (TIFFFlush(tiff.get()) != 1) throw write_error(file);
}

template <typename Value>
void write_plain(const std::filesystem::path& file, int nx, int ny, const PixelFormat& format,
                 std::span<const Value> values) {
  write_tiles(file, nx, ny, format, [&](std::size_t source, std::uint32_t count, unsigned char* out) {
    std::memcpy(out, values.data() + source, count * sizeof(Value));
  });
}

// Opens a layer and checks that it is what scene.yaml promises.
TiffPointer open_layer(const std::filesystem::path& file, const LayerRegion& region, PixelFormat& format) {
  prepare_library();
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) throw input_error(file.string(), "the layer is missing");
  TiffPointer tiff(TIFFOpen(file.c_str(),
                            "rm"));  // not mapped: a file may be cut short while it is read
  if (!tiff) throw input_error(file.string(), "not a readable TIFF: " + tiff_message, "a layer of a scene");
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t tile_width = 0;
  std::uint32_t tile_height = 0;
  std::uint16_t bits = 0;
  std::uint16_t samples = 1;
  std::uint16_t sample_format = SAMPLEFORMAT_UINT;
  TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height);
  TIFFGetField(tiff.get(), TIFFTAG_TILEWIDTH, &tile_width);
  TIFFGetField(tiff.get(), TIFFTAG_TILELENGTH, &tile_height);
  TIFFGetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &sample_format);
  const bool wide_float = format.sample_format == SAMPLEFORMAT_IEEEFP && bits == 64;
  if (width != static_cast<std::uint32_t>(region.level_nx) || height != static_cast<std::uint32_t>(region.level_ny) ||
      tile_width != kTileSize || tile_height != kTileSize || samples != format.samples ||
      sample_format != format.sample_format || (bits != format.bits && !wide_float)) {
    throw input_error(file.string(),
                      fmt::format("the layer has {}x{} pixels of {}x{} bits in {}x{} tiles", width, height, samples,
                                  bits, tile_width, tile_height),
                      fmt::format("{}x{} pixels of {}x{} bits in {}x{} tiles", region.level_nx, region.level_ny,
                                  format.samples, format.bits, kTileSize, kTileSize));
  }
  format.bits = bits;
  // Before memory is taken for what the file only promises: plain pixels are all there, packed ones cannot be packed
  // closer than deflate packs zeros.
  std::uint16_t compression = COMPRESSION_NONE;
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_COMPRESSION, &compression);
  const double closest = compression == COMPRESSION_NONE ? 1.0 : 1032.0;
  const double pixels = static_cast<double>(width) * height * static_cast<double>(format.bytes());
  const auto bytes = static_cast<double>(std::filesystem::file_size(file, code));
  if (code || bytes * closest < pixels) {
    throw input_error(file.string(),
                      fmt::format("the layer's {}x{} pixels are not in its {} bytes", width, height, bytes),
                      "an undamaged layer");
  }
  return tiff;
}

template <typename Value, typename Convert>
void read_tiles(const std::filesystem::path& file, const LayerRegion& region, PixelFormat format,
                std::span<Value> values, const Convert& convert) {
  const TiffPointer tiff = open_layer(file, region, format);
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
      if (TIFFReadTile(tiff.get(), tile.data(), static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(top), 0,
                       0) < 0) {
        throw input_error(file.string(), "a tile cannot be read: " + tiff_message, "an undamaged layer");
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

constexpr PixelFormat kByte{8, 1, SAMPLEFORMAT_UINT};
constexpr PixelFormat kRgba{8, 4, SAMPLEFORMAT_UINT};

}  // namespace

void write_layer(const std::filesystem::path& file, int nx, int ny, std::span<const float> values) {
  constexpr float kFar = 1000.0F;  // metres, beyond which float32 would leave less than 0.1 mm
  const bool wide = std::any_of(values.begin(), values.end(), [](float v) { return std::abs(v) > kFar; });
  if (!wide) return write_plain(file, nx, ny, PixelFormat{}, values);
  write_tiles(file, nx, ny, PixelFormat{64, 1, SAMPLEFORMAT_IEEEFP},
              [&](std::size_t source, std::uint32_t count, unsigned char* out) {
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

bool keeps_scan_axes(const Eigen::Matrix4d& scan_from_grid) {
  const double scale = scan_from_grid(0, 0);
  const double slack = 1e-12 * std::abs(scale);
  return scale > 0.0 && std::abs(scan_from_grid(1, 1) - scale) <= slack && std::abs(scan_from_grid(0, 1)) <= slack &&
         std::abs(scan_from_grid(1, 0)) <= slack && std::abs(scan_from_grid(0, 2)) <= slack &&
         std::abs(scan_from_grid(1, 2)) <= slack;
}

std::string world_file(const Lattice& lattice, const Eigen::Matrix4d& scan_from_grid) {
  double scale = 1.0;
  double x = lattice.x_m(0);
  double y = lattice.y_m(lattice.ny - 1);
  if (keeps_scan_axes(scan_from_grid)) {
    scale = scan_from_grid(0, 0);
    x = scale * x + scan_from_grid(0, 3);
    y = scale * y + scan_from_grid(1, 3);
  }
  const double step = scale * lattice.spacing_m;
  return fmt::format("{:.12g}\n0\n0\n{:.12g}\n{:.17g}\n{:.17g}\n", step, -step, x, y);
}

}  // namespace sparsha::pipeline
