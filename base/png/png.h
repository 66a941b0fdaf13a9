// PNG pictures through libpng: the one place that writes them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sparsha {

/// What a picture is. Rows are written from the top down.
struct PngFormat {
  enum class Pixel { grey16, rgb8, palette8 };  ///< 2 bytes (big-endian), 3 bytes, 1 byte per pixel
  int width = 0;
  int height = 0;
  Pixel pixel = Pixel::rgb8;
  std::vector<std::array<std::uint8_t, 3>> palette;  ///< palette8: up to 256 colours
  double pixel_m = 0.0;                              ///< physical size of a pixel, metres; 0 = unknown
  bool detailed = false;                             ///< noise-like detail: a fast deflate level loses little
  std::string description;                           ///< for people (tEXt); empty = none

  /// What 16-bit grey means, for programs (pCAL): value = first + slope * grey / 65535, in `unit`.
  struct Calibration {
    std::string purpose, unit, first, slope;
  };
  std::unique_ptr<Calibration> calibration;
};

/// Writes row by row. The same pixels give the same bytes.
class PngWriter {
 public:
  using Sink = std::function<void(std::span<const std::byte>)>;

  /// `sink` gets the file's bytes in order; what it throws passes through. Throws Error{failure}.
  PngWriter(const PngFormat& format, Sink sink);
  ~PngWriter();
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  /// width * bytes per pixel.
  void write_row(std::span<const std::uint8_t> row);
  /// After the last row; what is not finished is not whole.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A whole picture as bytes. Throws Error{failure}.
[[nodiscard]] std::string encode_png(const PngFormat& format, std::span<const std::uint8_t> pixels);

/// A whole picture as a file. Throws Error{failure} that names the file.
void write_png(const std::filesystem::path& file, const PngFormat& format, std::span<const std::uint8_t> pixels);

}  // namespace sparsha
