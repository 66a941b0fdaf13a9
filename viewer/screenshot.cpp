// One picture without a display.
#include "viewer/screenshot.h"

#include <vector>

#include "base/png.h"
#include "scene/scene.h"
#include "viewer/controller/controller.h"
#include "viewer/gl/offscreen.h"
#include "viewer/gui/gui.h"
#include "viewer/picture.h"

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
                      const std::filesystem::path& file) {
  constexpr int kWidth = 1280, kHeight = 720;
  const gl::OffscreenContext context;
  Picture picture;
  picture.set_scene(scene);
  Controller controller({}, settings_of(config));
  controller.set_scene(scene);
  const auto height_at = [&](double x_m, double y_m) { return picture.height_at(x_m, y_m); };
  controller.update(0.0, state, kWidth, kHeight, height_at);
  const gl::Target target(kWidth, kHeight, false);
  picture.draw(controller.frame(), target.framebuffer(), kWidth, kHeight);
  Gui gui;
  gui.draw(controller.frame(), controller.buttons(), picture, kWidth, kHeight, 0.01);
  write_rgba(file, kWidth, kHeight, target.read_pixels());
}

}  // namespace sparsha::viewer
