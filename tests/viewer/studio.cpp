// A picture without a display.
#include "studio.h"
#include "scene/scene.h"

#include <algorithm>

namespace sparsha::viewer::test {

Pixel Image::at(int x, int y) const {
  const std::size_t k =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  return {rgba.at(k), rgba.at(k + 1), rgba.at(k + 2)};
}

double Image::mean_luminance(const Rect& rect) const {
  double sum = 0.0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x) sum += at(x, y).luminance();
  return sum / (rect.width * rect.height);
}

Image::Spot Image::find(const Rect& rect, const std::function<bool(const Pixel&)>& condition) const {
  Spot spot;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      if (!condition(at(x, y))) continue;
      ++spot.count;
      spot.x += x + 0.5;
      spot.y += y + 0.5;
      spot.left = std::min(spot.left, x);
      spot.right = std::max(spot.right, x);
      spot.top = std::min(spot.top, y);
      spot.bottom = std::max(spot.bottom, y);
    }
  if (spot.count > 0) {
    spot.x /= spot.count;
    spot.y /= spot.count;
  }
  return spot;
}

Studio::Studio(scene::ScenePointer scene, ViewSettings settings, Connections connections)
    : context_(std::make_unique<gl::OffscreenContext>(true)) {
  gl::watch_errors(errors_);
  picture_ = std::make_unique<Picture>();
  gui_ = std::make_unique<Gui>();
  controller_ = std::make_unique<Controller>(connections, settings);
  picture_->set_scene(scene);
  controller_->set_scene(std::move(scene));
}

Studio::~Studio() { strike(); }

void Studio::strike() {
  gui_.reset();
  picture_.reset();
}

Image Studio::draw(const haptics::State& state, int width, int height, bool interface) {
  controller_->update(
      time_s_, state, width, height, [&](double x_m, double y_m) { return picture_->touch_height_at(x_m, y_m); },
      [&](double x_m, double y_m) { return picture_->height_at(x_m, y_m); });
  const gl::Target target(width, height, false);
  picture_->draw(controller_->frame(), target.framebuffer(), width, height);
  if (interface) {
    gui_->draw(controller_->frame(), controller_->buttons(), *picture_, width, height, 0.01);
    controller_->set_boxes(gui_->boxes(), gui_->help_pages());
  }
  return {width, height, target.read_pixels()};
}

Image Studio::shoot(const haptics::State& state, int width, int height) { return draw(state, width, height, true); }
Image Studio::shoot_bare(const haptics::State& state, int width, int height) {
  return draw(state, width, height, false);
}

void Studio::act(Action action, int times) {
  for (int k = 0; k < times; ++k) controller_->act(action);
}

void Studio::settle(const haptics::State& state, int width, int height) {
  for (int k = 0; k < 300; ++k) {
    time_s_ += 0.02;
    controller_->update(
        time_s_, state, width, height, [&](double x_m, double y_m) { return picture_->touch_height_at(x_m, y_m); },
        [&](double x_m, double y_m) { return picture_->height_at(x_m, y_m); });
  }
}

}  // namespace sparsha::viewer::test
