// PNG pictures through libpng: the one place that reads them. Numbers (labels drawn over something) or colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
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

/// Row 0 is the top; the bytes of a pixel are red, green, blue, alpha.
struct ColourImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint32_t> rgba;
};

/// Of any PNG in memory, 8 bits a channel. `allow(width, height)` is asked before memory is taken for the pixels, and
/// may throw. Throws Error{input} with `name` for what is no PNG or is damaged.
[[nodiscard]] ColourImage read_colour_png(std::string_view bytes, const std::string& name,
                                          const std::function<void(std::size_t width, std::size_t height)>& allow);

}  // namespace sparsha
