// One surface in every format that is read, of any size: what files of hostile tests are made of.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <string_view>

namespace sparsha::pipeline::testing {

/// Waves over a square of side x side points, a millimetre apart.
struct Waves {
  int side = 0;

  [[nodiscard]] int points() const { return side * side; }
  [[nodiscard]] float x(int n) const { return 0.001F * static_cast<float>(n % side); }
  [[nodiscard]] float y(int n) const { return 0.001F * static_cast<float>(n / side); }
  [[nodiscard]] float z(int n) const { return 0.02F * std::sin(30.0F * x(n)) * std::cos(20.0F * y(n)); }
  /// Calls face(a, b, c) for two triangles a square.
  template <typename Face>
  void for_each_triangle(const Face& face) const {
    for (int j = 0; j + 1 < side; ++j) {
      for (int i = 0; i + 1 < side; ++i) {
        const int a = j * side + i;
        face(a, a + 1, a + side + 1);
        face(a, a + side + 1, a + side);
      }
    }
  }
  [[nodiscard]] int triangles() const { return 2 * (side - 1) * (side - 1); }
};

/// A file of the waves.
struct WaveFile {
  std::string_view format;  ///< Format::name
  std::string_view name;    ///< of the file
  std::string (*bytes)(const Waves& waves);
};

/// At least one of each format.
[[nodiscard]] std::span<const WaveFile> wave_files();

}  // namespace sparsha::pipeline::testing
