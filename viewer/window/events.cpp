#include "viewer/window/events.h"

#include <filesystem>
#include <utility>
#include <vector>

#include <backends/imgui_impl_glfw.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include "viewer/window/display_loss.h"
#include "viewer/window/keys.h"

namespace sparsha::viewer {
namespace {

WindowInputs& inputs_of(GLFWwindow* window) { return *static_cast<WindowInputs*>(glfwGetWindowUserPointer(window)); }

int modifiers_of(int mods) {
  return ((mods & GLFW_MOD_SHIFT) != 0 ? kShift : 0) | ((mods & GLFW_MOD_CONTROL) != 0 ? kControl : 0);
}

void on_key(GLFWwindow* window, int glfw_key, int scancode, int event, int mods) {
  WindowInputs& in = inputs_of(window);
  in.attract->touched();
  in.stirred = true;
  const int key = key_of(glfw_key, glfwGetKeyName(glfw_key, scancode), in.cloud != nullptr ? is_cloud_key : is_key);
  if (event == GLFW_RELEASE) {
    if (in.controller != nullptr) in.controller->release(key);
    return;
  }
  const KeyPress press{key, modifiers_of(mods), event == GLFW_REPEAT};
  if (key == 0) return;
  if (in.cloud != nullptr) {
    // Tab enters the panel, and Escape leaves it: ImGui's keys until then.
    if (key != key::kTab && !in.gui->wants_keyboard()) in.cloud->press(press);
  } else if (in.controller != nullptr) {
    in.controller->press(press);
  }
  in.change_mode();
}

void on_character(GLFWwindow* window, unsigned character) {
  WindowInputs& in = inputs_of(window);
  in.stirred = true;
  if (in.cloud == nullptr && in.controller != nullptr) in.controller->type(static_cast<char32_t>(character));
}

void on_move(GLFWwindow* window, double x, double y) {
  WindowInputs& in = inputs_of(window);
  in.attract->touched();
  in.stirred = true;
  in.mouse_x = x * in.pixel_ratio();
  in.mouse_y = y * in.pixel_ratio();
  if (in.cloud != nullptr) return in.cloud->mouse_move(in.mouse_x, in.mouse_y);
  if (in.controller == nullptr) return;
  in.controller->mouse_move(in.mouse_x, in.mouse_y, layout_of(in.width, in.height, in.controller->settings()),
                            in.picture->detail_view(), in.picture->stage(),
                            [&](double u, double v) { return in.picture->touch_height_at(u, v); });
}

void on_button(GLFWwindow* window, int button, int event, int mods) {
  WindowInputs& in = inputs_of(window);
  in.attract->touched();
  in.stirred = true;
  if (in.cloud == nullptr) {
    // Where it was clicked counts, and not where the last move was reported.
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(window, &x, &y);
    if (display_lost()) return;
    on_move(window, x, y);
  }
  if (button >= 0 && button < static_cast<int>(in.down.size())) {
    const auto at = static_cast<std::size_t>(button);
    in.down[at] = event == GLFW_PRESS;
    in.just_down[at] = in.just_down[at] || in.down[at];  // a click may be shorter than a frame
  }
  if (event == GLFW_PRESS && in.gui->wants_mouse()) return;
  if (in.cloud != nullptr) return in.cloud->mouse_button(button, event == GLFW_PRESS, modifiers_of(mods));
  if (in.controller == nullptr) return;
  in.controller->mouse_button(button, event == GLFW_PRESS, modifiers_of(mods));
}

void on_scroll(GLFWwindow* window, double /*x*/, double y) {
  int mods = 0;
  if (glfwGetKey(window, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS ||
      glfwGetKey(window, GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS)
    mods |= kControl;
  WindowInputs& in = inputs_of(window);
  in.attract->touched();
  in.stirred = true;
  if (in.cloud != nullptr) {
    if (!in.gui->wants_mouse()) in.cloud->mouse_wheel(y);
  } else if (in.controller != nullptr) {
    in.controller->mouse_wheel(y, mods);
  }
}

void on_drop(GLFWwindow* window, int count, const char** names) {
  const Connections& connections = *inputs_of(window).connections;
  std::vector<std::filesystem::path> files;
  for (int k = 0; k < count; ++k) files.emplace_back(names[k]);
  if (connections.drop) connections.drop(files);
}

}  // namespace

void listen(GLFWwindow* window, WindowInputs& inputs, bool kiosk) {
  glfwSetWindowUserPointer(window, &inputs);
  glfwSetKeyCallback(window, on_key);
  glfwSetCharCallback(window, on_character);
  glfwSetCursorPosCallback(window, on_move);
  glfwSetMouseButtonCallback(window, on_button);
  glfwSetScrollCallback(window, on_scroll);
  glfwSetDropCallback(window, on_drop);
  // Only the staff's keys end an exhibit.
  if (kiosk) glfwSetWindowCloseCallback(window, [](GLFWwindow* w) { glfwSetWindowShouldClose(w, GLFW_FALSE); });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { inputs_of(w).damaged = true; });
  // Told by events and not queried: no call waits for the answer of a lost display.
  glfwSetWindowIconifyCallback(window, [](GLFWwindow* w, int on) { inputs_of(w).iconified = on == GLFW_TRUE; });
  glfwSetWindowSizeCallback(window, [](GLFWwindow* w, int width, int) { inputs_of(w).window_width = width; });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int width, int height) {
    inputs_of(w).width = width;
    inputs_of(w).height = height;
    inputs_of(w).damaged = true;
  });
  glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int inside) {
    inputs_of(w).stirred = true;
    if (inside != GLFW_TRUE) inputs_of(w).mouse_x = inputs_of(w).mouse_y = -1e9;
  });
}

bool ask_sizes(GLFWwindow* window, WindowInputs& inputs) {
  int height = 0;
  glfwGetWindowSize(window, &inputs.window_width, &height);
  glfwGetFramebufferSize(window, &inputs.width, &inputs.height);
  return !display_lost();
}

GuiInput::GuiInput(GLFWwindow* window) {
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
}

GuiInput::~GuiInput() { ImGui_ImplGlfw_Shutdown(); }

void GuiInput::begin_frame(WindowInputs& inputs) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplayFramebufferScale = ImVec2(1.0F, 1.0F);  // the interface is laid out in framebuffer pixels
  io.MousePos = ImVec2(static_cast<float>(inputs.mouse_x), static_cast<float>(inputs.mouse_y));
  for (std::size_t button = 0; button < inputs.down.size(); ++button)
    io.MouseDown[button] = std::exchange(inputs.just_down[button], false) || inputs.down[button];
}

}  // namespace sparsha::viewer
