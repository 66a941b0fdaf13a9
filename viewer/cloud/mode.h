// The window before the depth scan: controller, picture and panel of the raw cloud in one.
#pragma once

#include <functional>
#include <string>

#include "viewer/cloud/controller.h"
#include "viewer/cloud/picture.h"
#include "viewer/frame.h"
#include "viewer/gui/gui.h"

namespace sparsha::viewer {

/// Needs a current context for its whole life. Positions are pixels of the window.
class CloudMode {
 public:
  CloudMode(Orienting orienting, std::function<void(const std::string&)> speak);

  void press(const KeyPress& press);
  void mouse_move(double x, double y) { controller_.mouse_move(x, y); }
  void mouse_button(int button, bool down, int modifiers) { controller_.mouse_button(button, down, modifiers); }
  void mouse_wheel(double steps) { controller_.mouse_wheel(steps); }

  /// One frame into a framebuffer, the window's is 0.
  void draw(Gui& gui, const ViewSettings& settings, unsigned framebuffer, int width, int height, double time_s,
            bool can_go_back);

  /// True while the next picture would be as the last one, but for what ImGui's own fields show.
  [[nodiscard]] bool rests() const;
  [[nodiscard]] CloudController& controller() { return controller_; }
  [[nodiscard]] const CloudPicture& picture() const { return picture_; }
  /// Carries out what was wished of the settings; Wish::back and Wish::quit are the window's, once each.
  [[nodiscard]] CloudController::Wish take_wish(ViewSettings& settings);

 private:
  CloudController controller_;
  CloudPicture picture_;
  std::function<void(const std::string&)> speak_;
  struct Said {
    std::string text;
    bool problem;
    double until_s;
  };
  std::vector<Said> said_;
  double before_s_ = 0.0;
};

}  // namespace sparsha::viewer
