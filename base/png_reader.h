// Pictures whose pixels are numbers: labels drawn over something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace sparsha {

/// Row 0 is the top.
struct NumberImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

/// Grey pixels of 1 to 16 bits as they are stored, palette pixels as their numbers in the palette. Throws Error{input}
/// for a file that is no such PNG, that is damaged, or that has more than 2^28 pixels.
[[nodiscard]] NumberImage read_number_png(const std::filesystem::path& file);

}  // namespace sparsha
