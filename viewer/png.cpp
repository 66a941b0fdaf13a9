// PNG through libpng's simple interface.
#include "viewer/png.h"

#include <cstddef>
#include <cstring>
#include <string>

#include <png.h>

#include "pipeline/base/error.h"
#include "pipeline/base/files.h"

namespace sparsha::viewer {

void write_png(const std::filesystem::path& file, int width, int height, const std::vector<unsigned char>& rgba) {
  std::vector<unsigned char> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t k = 0; k + 3 < rgba.size(); k += 4) rgb.insert(rgb.end(), {rgba[k], rgba[k + 1], rgba[k + 2]});
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  AtomicPath target(file);
  if (png_image_write_to_file(&image, target.temporary().string().c_str(), 0, rgb.data(), 3 * width, nullptr) == 0)
    throw Error(ErrorKind::failure, {file.string()}, std::string("cannot write the picture: ") + image.message);
  target.commit();
}

}  // namespace sparsha::viewer
