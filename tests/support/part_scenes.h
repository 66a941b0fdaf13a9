// A stone with an L as a polygon and an L as a label, for whoever asks where parts are.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "base/png/png.h"
#include "tests/support/scenes.h"

namespace sparsha::test {

/// A picture of numbers below 256; `value` of pixels, row 0 at the top.
inline void write_labels(const std::filesystem::path& file, int width, int height,
                         const std::function<int(int column, int row)>& value) {
  PngFormat format;
  format.width = width;
  format.height = height;
  format.pixel = PngFormat::Pixel::grey16;
  std::vector<std::uint8_t> pixels;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      pixels.push_back(0);
      pixels.push_back(static_cast<std::uint8_t>(value(column, row)));
    }
  write_png(file, format, pixels);
}

/// Upright from (0, 0) to (0.4, 1), its foot to (1, 0.4), times `size_m` at `at_m`.
inline std::vector<std::array<double, 2>> el_m(double size_m, const Eigen::Vector2d& at_m) {
  std::vector<std::array<double, 2>> corners{{0, 0}, {1, 0}, {1, 0.4}, {0.4, 0.4}, {0.4, 1}, {0, 1}};
  for (auto& corner : corners) corner = {at_m.x() + size_m * corner[0], at_m.y() + size_m * corner[1]};
  return corners;
}

/// 0.1 m wide and level. "Polygon", an L of 30 mm at (60, 10) mm; "Label", value 5, one of 30 mm at (10, 10) mm, in a
/// picture of 0.1 m; both with `touch`.
inline scene::ScenePointer els(const std::filesystem::path& labels, const scene::PartTouch& touch = {},
                               const EditDescription& edit = {}) {
  constexpr double kMm = 0.001;
  write_labels(labels, 200, 200, [](int column, int row) {
    const double x = column / 2.0 - 10.0, y = (199 - row) / 2.0 - 10.0;  // of the pixel's corner, mm
    return x >= 0 && y >= 0 && x < 30 && y < 30 && (x < 12 || y < 12) ? 5 : 0;
  });
  return scene_of([](double, double) { return 0.0; }, 201, 0.1, 201, Eigen::Vector3d::Zero(),
                  [&](scene::SceneDescription& d) {
                    d.config.audio.emplace();
                    d.config.audio->labels = scene::LabelImageConfig{labels, std::array<double, 4>{0, 0, 0.1, 0.1}};
                    scene::PartConfig polygon;
                    polygon.name = polygon.say = "Polygon";
                    polygon.polygon_m = el_m(30.0 * kMm, {60.0 * kMm, 10.0 * kMm});
                    polygon.touch = touch;
                    scene::PartConfig label;
                    label.name = label.say = "Label";
                    label.label = 5;
                    label.touch = touch;
                    d.config.parts = {polygon, label};
                    if (edit) edit(d);
                  });
}

}  // namespace sparsha::test
