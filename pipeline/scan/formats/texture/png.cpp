#include <utility>

#include "base/png/png_reader.h"
#include "pipeline/scan/formats/texture/picture.h"

namespace sparsha::pipeline::pictures {

ColourPicture decode_png(std::string_view bytes, const std::string& name) {
  ColourImage image = read_colour_png(
      bytes, name, [&](std::size_t width, std::size_t height) { require_size(width, height, bytes.size(), name); });
  return {image.width, image.height, std::move(image.rgba)};
}

}  // namespace sparsha::pipeline::pictures
