// Text, buttons and frames over the picture, drawn with Dear ImGui.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "viewer/actions/actions.h"
#include "viewer/frame.h"
#include "viewer/gui/brush.h"

namespace sparsha::viewer {

class Picture;
struct Brush;

/// One ImGui context with its fonts. Needs a current OpenGL context for its whole life.
class Gui {
 public:
  Gui();
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// Draws the interface of one frame over what Picture drew, into the bound framebuffer. `seconds` is the time since
  /// the last frame.
  void draw(const Frame& frame, const std::vector<Action>& buttons, const Picture& picture, int width, int height,
            double seconds);
  /// The same for other pieces: `over` draws over the picture and below ImGui's windows, `above` above them.
  void draw_pieces(const ViewSettings& settings, int width, int height, double seconds,
                   const std::function<void(const Brush& over, const Brush& above)>& pieces);
  /// Whether Tab and arrows go through the fields of panels.
  void use_keyboard(bool on);
  /// True while keys belong to a field or to the panel that Tab has entered.
  [[nodiscard]] bool wants_keyboard() const;
  /// True when the mouse is over a window of Dear ImGui's own.
  [[nodiscard]] bool wants_mouse() const;
  /// What the last draw() has left to be clicked; later ones lie on top.
  [[nodiscard]] const std::vector<Clickable>& boxes() const;
  [[nodiscard]] int help_pages() const;
  /// The words of the last draw().
  [[nodiscard]] const std::vector<DrawnText>& texts() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::viewer
