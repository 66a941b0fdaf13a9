// Events of the window, from GLFW to the controller, the raw cloud and Dear ImGui.
#pragma once

#include <array>
#include <functional>

#include "viewer/cloud/mode.h"
#include "viewer/controller/controller.h"
#include "viewer/gui/gui.h"
#include "viewer/kiosk/attract.h"
#include "viewer/picture/picture.h"
#include "viewer/viewer.h"

struct GLFWwindow;

namespace sparsha::viewer {

/// What the callbacks reach through the window's user pointer. Positions are in framebuffer pixels.
struct WindowInputs {
  Controller* controller = nullptr;   ///< null before the first depth scan
  CloudMode* cloud = nullptr;         ///< while the raw cloud is shown, which then gets all events
  std::function<void()> change_mode;  ///< between the two, when that was asked for: the next event belongs to the other
  Picture* picture = nullptr;
  Gui* gui = nullptr;
  Attract* attract = nullptr;
  const Connections* connections = nullptr;
  // Told by events: on a lost display the queries of GLFW return uninitialised values.
  int width = 1, height = 1;                ///< of the framebuffer
  int window_width = 1;                     ///< in the units of the mouse
  double mouse_x = -1e9, mouse_y = -1e9;    ///< framebuffer pixels; far away while it is not over the window
  std::array<bool, 3> down{}, just_down{};  ///< left, right, middle
  [[nodiscard]] double pixel_ratio() const {
    return window_width > 0 ? static_cast<double>(width) / window_width : 1.0;
  }
  bool damaged = true;   ///< the window's contents are lost
  bool stirred = false;  ///< a key, a button or the mouse since the last picture
  bool iconified = false;
};

/// From now on events of the window go to `inputs`, which outlives it. In kiosk mode it cannot be closed.
void listen(GLFWwindow* window, WindowInputs& inputs, bool kiosk);

/// What no event has told yet; false when the display is lost, and with it the answer.
bool ask_sizes(GLFWwindow* window, WindowInputs& inputs);

/// ImGui's share of the events; callbacks set before it are still called.
struct GuiInput {
  explicit GuiInput(GLFWwindow* window);
  ~GuiInput();
  GuiInput(const GuiInput&) = delete;
  GuiInput& operator=(const GuiInput&) = delete;

  /// Instead of ImGui_ImplGlfw_NewFrame, which asks the display for what events have told.
  static void begin_frame(WindowInputs& inputs);
};

}  // namespace sparsha::viewer
