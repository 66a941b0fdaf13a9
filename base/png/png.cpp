// libpng reports an error by a long jump to where its caller last stood: every call into libpng goes through attempt(),
// which has no objects with destructors between the two.
#include "base/png/png.h"

#include <png.h>

#include <cmath>
#include <csetjmp>
#include <exception>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"

namespace sparsha {
namespace {

constexpr int kFastDeflate = 3;
constexpr double kMostPixelsPerMetre = 2147483647.0;

std::size_t bytes_per_pixel(PngFormat::Pixel pixel) {
  switch (pixel) {
    case PngFormat::Pixel::grey16:
      return 2;
    case PngFormat::Pixel::rgb8:
      return 3;
    case PngFormat::Pixel::palette8:
      break;
  }
  return 1;
}

int colour_type(PngFormat::Pixel pixel) {
  switch (pixel) {
    case PngFormat::Pixel::grey16:
      return PNG_COLOR_TYPE_GRAY;
    case PngFormat::Pixel::rgb8:
      return PNG_COLOR_TYPE_RGB;
    case PngFormat::Pixel::palette8:
      break;
  }
  return PNG_COLOR_TYPE_PALETTE;
}

}  // namespace

struct PngWriter::Implementation {
  Sink sink;
  std::size_t row_bytes = 0;
  std::string message;
  std::exception_ptr thrown;  // by the sink; C code must not see it pass
  png_structp png = nullptr;
  png_infop info = nullptr;

  ~Implementation() { png_destroy_write_struct(&png, &info); }

  static void on_error(png_structp png, png_const_charp text) {
    static_cast<Implementation*>(png_get_error_ptr(png))->message = text;
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_bytes(png_structp png, png_bytep data, png_size_t size) {
    auto& self = *static_cast<Implementation*>(png_get_io_ptr(png));
    if (self.take(data, size)) return;
    png_longjmp(png, 1);
  }
  static void on_flush(png_structp) {}

  bool take(png_bytep data, png_size_t size) noexcept {
    try {
      sink({reinterpret_cast<const std::byte*>(data), size});
      return true;
    } catch (...) {
      thrown = std::current_exception();
      return false;
    }
  }

  /// False when libpng has jumped.
  template <typename Call>
  bool attempt(const Call& call) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng has no other way
    call();
    return true;
  }

  [[noreturn]] void fail() {
    if (thrown) std::rethrow_exception(std::exchange(thrown, nullptr));
    throw Error(ErrorKind::failure, {}, "cannot write a PNG: " + message);
  }
};

PngWriter::PngWriter(const PngFormat& format, Sink sink) : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.sink = std::move(sink);
  self.row_bytes = bytes_per_pixel(format.pixel) * static_cast<std::size_t>(format.width);
  self.message = "libpng has no memory";
  self.png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &self, Implementation::on_error, Implementation::on_warning);
  if (self.png != nullptr) self.info = png_create_info_struct(self.png);
  if (self.info == nullptr) self.fail();

  std::array<png_color, 256> palette{};
  const std::size_t colours = std::min(format.palette.size(), palette.size());
  for (std::size_t k = 0; k < colours; ++k) {
    palette[k] = {format.palette[k][0], format.palette[k][1], format.palette[k][2]};
  }
  const double per_metre = format.pixel_m > 0.0 ? std::round(1.0 / format.pixel_m) : 0.0;
  std::string key = "Description";
  std::string description = format.description;
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = key.data();
  text.text = description.data();
  PngFormat::Calibration meaning = format.calibration ? *format.calibration : PngFormat::Calibration{};
  std::array<char*, 2> parameters{meaning.first.data(), meaning.slope.data()};

  const bool done = self.attempt([&] {
    png_set_write_fn(self.png, &self, Implementation::on_bytes, Implementation::on_flush);
    if (format.detailed) {
      png_set_compression_level(self.png, kFastDeflate);
      png_set_filter(self.png, 0, PNG_FILTER_NONE | PNG_FILTER_SUB);
    }
    png_set_IHDR(self.png, self.info, static_cast<png_uint_32>(format.width), static_cast<png_uint_32>(format.height),
                 format.pixel == PngFormat::Pixel::grey16 ? 16 : 8, colour_type(format.pixel), PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (format.pixel == PngFormat::Pixel::palette8)
      png_set_PLTE(self.png, self.info, palette.data(), static_cast<int>(colours));
    if (format.calibration) {
      png_set_pCAL(self.png, self.info, meaning.purpose.c_str(), 0, 65535, PNG_EQUATION_LINEAR, 2, meaning.unit.c_str(),
                   parameters.data());
    }
    if (per_metre >= 1.0 && per_metre < kMostPixelsPerMetre) {
      const auto density = static_cast<png_uint_32>(per_metre);
      png_set_pHYs(self.png, self.info, density, density, PNG_RESOLUTION_METER);
    }
    if (!description.empty()) png_set_text(self.png, self.info, &text, 1);
    png_write_info(self.png, self.info);
  });
  if (!done) self.fail();
}

PngWriter::~PngWriter() = default;

void PngWriter::write_row(std::span<const std::uint8_t> row) {
  Implementation& self = *implementation_;
  if (row.size() != self.row_bytes) throw Error(ErrorKind::failure, {}, "a PNG row of the wrong length");
  if (!self.attempt([&] { png_write_row(self.png, row.data()); })) self.fail();
}

void PngWriter::finish() {
  Implementation& self = *implementation_;
  if (!self.attempt([&] { png_write_end(self.png, self.info); })) self.fail();
}

std::string encode_png(const PngFormat& format, std::span<const std::uint8_t> pixels) {
  std::string bytes;
  PngWriter writer(format, [&](std::span<const std::byte> part) {
    bytes.append(reinterpret_cast<const char*>(part.data()), part.size());
  });
  const std::size_t row = bytes_per_pixel(format.pixel) * static_cast<std::size_t>(format.width);
  for (std::size_t j = 0; j < static_cast<std::size_t>(format.height); ++j)
    writer.write_row(pixels.subspan(j * row, row));
  writer.finish();
  return bytes;
}

void write_png(const std::filesystem::path& file, const PngFormat& format, std::span<const std::uint8_t> pixels) {
  write_file(file, encode_png(format, pixels));
}

}  // namespace sparsha
