// A window of GLFW with an OpenGL context, on the screen or as large as it.
#pragma once

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

/// Opens the window and makes its context current. Throws Error{failure}.
void open_window(WindowHandle& window, const ViewerOptions& options);
/// False without a screen.
bool fill_screen(GLFWwindow* window);
/// Full screen and back to where the window was.
void switch_full_screen(WindowHandle& window);

}  // namespace sparsha::viewer
