// Pictures that lie on meshes: PNG and JPEG, whatever their names say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sparsha::pipeline {

/// Pixels of 8 bits a channel, 0xAABBGGRR in sRGB; row 0 is the top.
struct ColourPicture {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint32_t> rgba;
};

/// Throws Error{input} that names `name` for bytes that are no PNG or JPEG, that are damaged or cut short, and for more
/// than 2^28 pixels or more than so few bytes can hold.
[[nodiscard]] ColourPicture decode_picture(std::string_view bytes, const std::string& name);

namespace pictures {

/// Throws where a picture of this size cannot be in `bytes` bytes; memory is taken for it afterwards. A PNG holds at
/// most 1032 times its bytes, a JPEG of one colour less.
void require_size(std::uint64_t width, std::uint64_t height, std::size_t bytes, const std::string& name);
[[nodiscard]] ColourPicture decode_png(std::string_view bytes, const std::string& name);
/// Grey, YCbCr, RGB and Adobe's inverted CMYK, baseline and progressive.
[[nodiscard]] ColourPicture decode_jpeg(std::string_view bytes, const std::string& name);

}  // namespace pictures
}  // namespace sparsha::pipeline
