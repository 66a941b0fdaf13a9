// A window of GLFW with an OpenGL context, on the screen or as large as it.
#pragma once

#include <array>

#include "viewer/camera/camera.h"
#include "viewer/viewer.h"

struct GLFWwindow;

namespace sparsha::viewer {

/// GLFW between construction and destruction. Throws Error{failure} when there is no display.
struct GlfwLibrary {
  GlfwLibrary();
  ~GlfwLibrary();
  GlfwLibrary(const GlfwLibrary&) = delete;
  GlfwLibrary& operator=(const GlfwLibrary&) = delete;
};

struct WindowHandle {
  GLFWwindow* handle = nullptr;
  int x = 80, y = 80, width = 1280, height = 720;  ///< before it filled the screen
  WindowHandle() = default;
  ~WindowHandle();
  WindowHandle(const WindowHandle&) = delete;
  WindowHandle& operator=(const WindowHandle&) = delete;
};

/// Where a window of that size is to be so that it lies in `area` together with its frame (left, top, right, bottom),
/// screen coordinates: no side is longer than there is room for. An area without extent limits nothing.
[[nodiscard]] Rect fitted_window(int width, int height, const Rect& area, const std::array<int, 4>& frame);

/// Opens the window, no larger than the primary monitor's work area, and makes its context current. Throws
/// Error{failure}.
void open_window(WindowHandle& window, const ViewerOptions& options);
/// False without a screen.
bool fill_screen(GLFWwindow* window);
/// Full screen and back to where the window was.
void switch_full_screen(WindowHandle& window);

}  // namespace sparsha::viewer
