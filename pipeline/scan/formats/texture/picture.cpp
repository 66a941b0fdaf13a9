#include "pipeline/scan/formats/texture/picture.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sparsha::pipeline {
namespace {

/// Of the kinds that are found in place of PNG and JPEG.
std::string_view kind_of(std::string_view bytes) {
  if (bytes.empty()) return "an empty file";
  if (bytes.starts_with("RIFF") && bytes.size() >= 12 && bytes.substr(8, 4) == "WEBP") return "a WebP picture";
  if (bytes.starts_with("\xABKTX")) return "a KTX texture";
  if (bytes.starts_with("BM")) return "a BMP picture";
  if (bytes.starts_with("DDS ")) return "a DDS texture";
  if (bytes.starts_with("GIF8")) return "a GIF picture";
  if (bytes.starts_with(std::string_view("II*\0", 4)) || bytes.starts_with(std::string_view("MM\0*", 4)))
    return "a TIFF picture";
  return "no picture that is known here";
}

}  // namespace

namespace pictures {

void require_size(std::uint64_t width, std::uint64_t height, std::size_t bytes, const std::string& name) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 28U, kAlways = std::uint64_t{1} << 22U, kPerByte = 1100;
  const bool fits = width > 0 && height > 0 && width <= kMost && height <= kMost && width * height <= kMost;
  if (!fits) {
    throw input_error(name, fmt::format("a picture of {} x {} pixels", width, height), "1 to 2^28 pixels");
  }
  if (width * height > kAlways && width * height / kPerByte > bytes) {
    throw input_error(name, fmt::format("a picture of {} x {} pixels in {} bytes", width, height, bytes),
                      "a whole file; it may be cut short");
  }
}

}  // namespace pictures

ColourPicture decode_picture(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("\x89PNG\r\n")) return pictures::decode_png(bytes, name);
  if (bytes.starts_with("\xFF\xD8\xFF")) return pictures::decode_jpeg(bytes, name);
  throw input_error(name, std::string(kind_of(bytes)), "a PNG or a JPEG");
}

}  // namespace sparsha::pipeline
