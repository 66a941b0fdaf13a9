// One picture without a display.
#include "viewer/controller.h"
#include "viewer/gl/offscreen.h"
#include "viewer/gui/gui.h"
#include "viewer/picture.h"
#include "viewer/png.h"

namespace sparsha::viewer {

void write_screenshot(const pipeline::ScenePointer& scene, const haptics::State& state,
                      const pipeline::ViewerConfig& config, const std::filesystem::path& file) {
  constexpr int kWidth = 1280, kHeight = 720;
  const gl::OffscreenContext context;
  Picture picture;
  picture.set_scene(scene);
  ViewSettings settings;
  settings.colour = config.colour;
  settings.anaglyph = config.stereo == pipeline::ViewerConfig::Stereo::anaglyph;
  Controller controller({}, settings);
  controller.set_scene(scene);
  const auto height_at = [&](double x_m, double y_m) { return picture.height_at(x_m, y_m); };
  controller.update(0.0, state, kWidth, kHeight, height_at);
  const gl::Target target(kWidth, kHeight, false);
  picture.draw(controller.frame(), target.framebuffer(), kWidth, kHeight);
  Gui gui;
  static_cast<void>(gui.draw(controller.frame(), controller.buttons(), picture, kWidth, kHeight, 0.01));
  write_png(file, kWidth, kHeight, target.read_pixels());
}

}  // namespace sparsha::viewer
