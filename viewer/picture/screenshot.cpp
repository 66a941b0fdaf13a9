// One picture without a display.
#include "viewer/picture/screenshot.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include "base/png/png.h"
#include "scene/scene.h"
#include "viewer/controller/controller.h"
#include "viewer/gl/offscreen.h"
#include "viewer/gui/gui.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer {
namespace {

/// `rgba`: first row at the top.
void write_rgba(const std::filesystem::path& file, int width, int height, const std::vector<unsigned char>& rgba) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t k = 0; k + 3 < rgba.size(); k += 4) rgb.insert(rgb.end(), {rgba[k], rgba[k + 1], rgba[k + 2]});
  PngFormat format;
  format.width = width;
  format.height = height;
  write_png(file, format, rgb);
}

}  // namespace

void write_framebuffer(int width, int height, const std::filesystem::path& file) {
  write_rgba(file, width, height, gl::read_pixels(0, width, height));
}

void write_screenshot(const scene::ScenePointer& scene, const haptics::State& state, const scene::ViewerConfig& config,
                      const std::filesystem::path& file, const Strip& strip) {
  constexpr int kWidth = 1280, kHeight = 720;
  const gl::OffscreenContext context;
  Picture picture;
  picture.set_scene(scene);
  Controller controller({}, settings_of(config));
  controller.set_scene(scene);
  controller.frame().strip = strip;
  const auto height_at = [&](double x_m, double y_m) { return picture.height_at(x_m, y_m); };
  controller.update(0.0, state, kWidth, kHeight, height_at);
  const gl::Target target(kWidth, kHeight, false);
  picture.draw(controller.frame(), target.framebuffer(), kWidth, kHeight);
  Gui gui;
  gui.draw(controller.frame(), controller.buttons(), picture, kWidth, kHeight, 0.01);
  write_rgba(file, kWidth, kHeight, target.read_pixels());
}

void write_six_views(const scene::ScenePointer& scene, int side, const std::filesystem::path& file) {
  struct Seen {
    double turn_rad, tilt_rad;
  };
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  constexpr std::array<Seen, 6> kSides{
      {{0.0, 0.0}, {kQuarter, 0.0}, {2.0 * kQuarter, 0.0}, {-kQuarter, 0.0}, {0.0, -kQuarter}, {0.0, kQuarter}}};
  constexpr int kColumns = 3;
  const bool whole = is_whole(scene->description());
  const int columns = whole ? kColumns : 1, rows = whole ? static_cast<int>(kSides.size()) / kColumns : 1;
  const gl::OffscreenContext context;
  Picture picture;
  picture.set_scene(scene);
  const gl::Target target(side, side, false);
  std::vector<unsigned char> sheet(4 * static_cast<std::size_t>(columns * side) *
                                   static_cast<std::size_t>(rows * side));
  const auto row_bytes = static_cast<std::ptrdiff_t>(4 * side);
  for (int k = 0; k < columns * rows; ++k) {
    const Seen& seen = kSides[static_cast<std::size_t>(k)];
    picture.draw_side(seen.turn_rad, seen.tilt_rad, target.framebuffer(), side);
    const std::vector<unsigned char> pixels = target.read_pixels();
    for (int y = 0; y < side; ++y) {
      const std::ptrdiff_t to = ((k / columns * side + y) * columns + k % columns) * row_bytes;
      std::copy_n(pixels.begin() + y * row_bytes, row_bytes, sheet.begin() + to);
    }
  }
  write_rgba(file, columns * side, rows * side, sheet);
}

}  // namespace sparsha::viewer
