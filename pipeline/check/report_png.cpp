// A fast deflate level: these pictures are noise-like in detail, and higher levels buy little.
#include "pipeline/check/report_png.h"

#include <png.h>

#include <array>
#include <cmath>

#include "pipeline/base/error.h"

namespace sparsha::pipeline {
namespace {

constexpr int kDeflateLevel = 3;

void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}
void flush(png_structp) {}
[[noreturn]] void fail(png_structp, png_const_charp message) {
  throw Error(ErrorKind::failure, {}, std::string("cannot encode a PNG: ") + message);
}
void ignore(png_structp, png_const_charp) {}

/// Frees libpng's structures also when an exception passes.
struct Writer {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  Writer() = default;
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
};

}  // namespace

std::string encode_png(const std::vector<std::uint8_t>& pixels, int width, int height, const Palette& palette,
                       double pixel_m) {
  const Writer writer;
  if (writer.info == nullptr) throw Error(ErrorKind::failure, {}, "cannot encode a PNG: libpng has no memory");
  std::string bytes;
  png_set_write_fn(writer.png, &bytes, append, flush);
  png_set_compression_level(writer.png, kDeflateLevel);
  png_set_filter(writer.png, 0, PNG_FILTER_NONE | PNG_FILTER_SUB);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::array<png_color, 256> colours{};
  for (std::size_t k = 0; k < palette.size(); ++k) colours[k] = {palette[k].r, palette[k].g, palette[k].b};
  png_set_PLTE(writer.png, writer.info, colours.data(), static_cast<int>(colours.size()));
  if (pixel_m > 0) {
    const double per_metre = std::round(1 / pixel_m);
    if (per_metre >= 1 && per_metre < 2147483647.0)
      png_set_pHYs(writer.png, writer.info, static_cast<png_uint_32>(per_metre), static_cast<png_uint_32>(per_metre),
                   PNG_RESOLUTION_METER);
  }
  png_write_info(writer.png, writer.info);
  for (int j = 0; j < height; ++j)
    png_write_row(writer.png, pixels.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(width));
  png_write_end(writer.png, writer.info);
  return bytes;
}

void append_base64(std::string& text, const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t begin = text.size();
  text.resize(begin + (bytes.size() + 2) / 3 * 4);
  char* out = text.data() + begin;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t word = 0;
    for (std::size_t n = 0; n < 3; ++n)
      word = word << 8 | (k + n < bytes.size() ? static_cast<unsigned char>(bytes[k + n]) : 0U);
    for (std::size_t n = 0; n < 4; ++n) *out++ = k + n <= bytes.size() ? kDigits[word >> (18 - 6 * n) & 63U] : '=';
  }
}

}  // namespace sparsha::pipeline
