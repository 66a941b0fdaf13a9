#include "viewer/window/glfw_window.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "base/error.h"
#include "viewer/window/display_loss.h"

namespace sparsha::viewer {
namespace {

std::string last_glfw_error() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words != nullptr ? words : "no reason given";
}

Error no_window(const std::string& why) {
  return Error(ErrorKind::failure, {}, "no window can be opened: " + why,
               "a display with OpenGL 3.3, or --headless with --screenshot");
}

/// A window larger than the screen would be cut where no window manager makes it smaller.
void fit_to_monitor(WindowHandle& window) {
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr) return;
  Rect area;
  std::array<int, 4> frame{};
  glfwGetMonitorWorkarea(monitor, &area.x, &area.y, &area.width, &area.height);
  glfwGetWindowFrameSize(window.handle, &frame[0], &frame[1], &frame[2], &frame[3]);
  int width = 0, height = 0;
  glfwGetWindowSize(window.handle, &width, &height);  // by the scale of the monitor larger than was asked for
  const Rect fitted = fitted_window(width, height, area, frame);
  if (fitted.width == width && fitted.height == height) return;
  glfwSetWindowSize(window.handle, fitted.width, fitted.height);
  glfwSetWindowPos(window.handle, fitted.x, fitted.y);
}

}  // namespace

Rect fitted_window(int width, int height, const Rect& area, const std::array<int, 4>& frame) {
  const auto fitted = [](int wanted, int side, int borders) {
    constexpr int kLeast = 64;
    return side <= 0 ? wanted : std::min(wanted, std::max(side - borders, kLeast));
  };
  return {area.x + frame[0], area.y + frame[1], fitted(width, area.width, frame[0] + frame[2]),
          fitted(height, area.height, frame[1] + frame[3])};
}

GlfwLibrary::GlfwLibrary() {
  if (glfwInit() != GLFW_TRUE) throw no_window(last_glfw_error());
  survive_display_loss();
}

GlfwLibrary::~GlfwLibrary() { glfwTerminate(); }

WindowHandle::~WindowHandle() {
  if (handle != nullptr) glfwDestroyWindow(handle);
}

void open_window(WindowHandle& window, const ViewerOptions& options) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHint(GLFW_AUTO_ICONIFY, options.kiosk ? GLFW_FALSE : GLFW_TRUE);  // when another window gets the keyboard
  int width = options.width, height = options.height;
  GLFWmonitor* monitor = nullptr;
  if (options.kiosk) {
    monitor = glfwGetPrimaryMonitor();
    if (const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr) {
      width = mode->width;
      height = mode->height;
    }
  }
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);  // until it has its size; what fills the screen is shown all the same
  window.handle = glfwCreateWindow(width, height, "Sparsha", monitor, nullptr);
  if (window.handle == nullptr) throw no_window(last_glfw_error());
  if (monitor == nullptr) {
    fit_to_monitor(window);
    glfwShowWindow(window.handle);
  }
  glfwMakeContextCurrent(window.handle);
  glfwSwapInterval(1);
}

bool fill_screen(GLFWwindow* window) {
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
  if (mode == nullptr) return false;
  glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
  return true;
}

void switch_full_screen(WindowHandle& window) {
  if (glfwGetWindowMonitor(window.handle) != nullptr) {
    glfwSetWindowMonitor(window.handle, nullptr, window.x, window.y, window.width, window.height, GLFW_DONT_CARE);
    return;
  }
  glfwGetWindowPos(window.handle, &window.x, &window.y);
  glfwGetWindowSize(window.handle, &window.width, &window.height);
  fill_screen(window.handle);
}

bool display_available() {
#ifdef __linux__
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  // Without either name no connection is tried at all.
  if (!set("DISPLAY") && !set("WAYLAND_DISPLAY")) return false;
#endif
  if (glfwInit() != GLFW_TRUE) return false;
  glfwTerminate();
  return true;
}

}  // namespace sparsha::viewer
