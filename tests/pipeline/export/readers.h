// Readers of exported files that share no code with the program.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sparsha::test {

struct Mesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::array<std::uint8_t, 3>> colours;
};
[[nodiscard]] Mesh read_ply(const std::filesystem::path& file);
[[nodiscard]] Mesh read_obj(const std::filesystem::path& file);
[[nodiscard]] Mesh read_xyz(const std::filesystem::path& file);

/// Heights by file row and column, row 0 on top; NaN where unknown. World file: x = c + a column, y = f + e row.
struct Raster {
  std::uint32_t width = 0, height = 0;
  int bits = 0;
  std::vector<double> z;
  double a = 0, e = 0, c = 0, f = 0;
  std::string description;
  [[nodiscard]] double at(std::uint32_t column, std::uint32_t row) const { return z[row * width + column]; }
};
[[nodiscard]] Raster read_tif(const std::filesystem::path& file);
/// Grey values become metres by the file's own pCAL chunk.
[[nodiscard]] Raster read_png(const std::filesystem::path& file);

}  // namespace sparsha::test
