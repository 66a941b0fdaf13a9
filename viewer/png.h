// Pictures to PNG files.
#pragma once

#include <filesystem>
#include <vector>

namespace sparsha::viewer {

/// `rgba` is width * height * 4 bytes, first row at the top; alpha is dropped. Atomic. Throws Error{failure}.
void write_png(const std::filesystem::path& file, int width, int height, const std::vector<unsigned char>& rgba);

}  // namespace sparsha::viewer
