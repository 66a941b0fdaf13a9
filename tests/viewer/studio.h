// A picture without a display, and questions about its pixels.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "viewer/controller/controller.h"
#include "viewer/gl/offscreen.h"
#include "viewer/gui/gui.h"
#include "viewer/picture/picture.h"

namespace sparsha::viewer::test {

struct Pixel {
  int r = 0, g = 0, b = 0;
  [[nodiscard]] double luminance() const { return 0.2126 * r + 0.7152 * g + 0.0722 * b; }
};

/// First row at the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgba;

  [[nodiscard]] Pixel at(int x, int y) const;
  [[nodiscard]] double mean_luminance(const Rect& rect) const;
  /// Middle of all pixels of the rectangle that fulfil the condition; `count` is how many there are.
  struct Spot {
    double x = 0.0, y = 0.0;
    int count = 0, left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  };
  [[nodiscard]] Spot find(const Rect& rect, const std::function<bool(const Pixel&)>& condition) const;
};

/// Context, picture, controller and interface of one test; collects OpenGL errors.
class Studio {
 public:
  explicit Studio(scene::ScenePointer scene, ViewSettings settings = {}, Connections connections = {});
  ~Studio();

  /// One finished frame.
  Image shoot(const haptics::State& state = {}, int width = 1280, int height = 720);
  /// Only stone and hand, without the interface.
  Image shoot_bare(const haptics::State& state = {}, int width = 1280, int height = 720);
  void act(Action action, int times = 1);
  /// Lets the camera come to rest.
  void settle(const haptics::State& state = {}, int width = 1280, int height = 720);

  [[nodiscard]] Picture& picture() { return *picture_; }
  [[nodiscard]] const Gui& gui() const { return *gui_; }
  [[nodiscard]] Controller& controller() { return *controller_; }
  [[nodiscard]] const std::vector<std::string>& gl_errors() const { return errors_; }
  /// Frees everything that was drawn with; the context stays.
  void strike();

 private:
  Image draw(const haptics::State& state, int width, int height, bool interface);

  std::vector<std::string> errors_;
  std::unique_ptr<gl::OffscreenContext> context_;
  std::unique_ptr<Picture> picture_;
  std::unique_ptr<Gui> gui_;
  std::unique_ptr<Controller> controller_;
  double time_s_ = 0.0;
};

}  // namespace sparsha::viewer::test
