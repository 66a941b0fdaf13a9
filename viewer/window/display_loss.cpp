// Xlib's two handlers (since libX11 1.7). They are looked up by name, since GLFW need not be built for X.
#include "viewer/window/display_loss.h"

#include <atomic>

#include "base/system/library.h"

namespace sparsha::viewer {
namespace {

std::atomic<bool> lost{false};

extern "C" int remember_loss(void* /*display*/) {
  lost = true;
  return 0;
}
extern "C" void go_on(void* /*display*/, void* /*data*/) {}

template <typename Function>
Function* function(const char* name) {
  return reinterpret_cast<Function*>(system::find_symbol(name));
}

}  // namespace

void survive_display_loss() {
  using Handler = int (*)(void*);
  using ExitHandler = void (*)(void*, void*);
  lost = false;
  auto* const display = function<void*()>("glfwGetX11Display");
  auto* const set_handler = function<Handler(Handler)>("XSetIOErrorHandler");
  auto* const set_exit = function<void(void*, ExitHandler, void*)>("XSetIOErrorExitHandler");
  if (display == nullptr || set_handler == nullptr || set_exit == nullptr || display() == nullptr) return;
  set_handler(remember_loss);
  set_exit(display(), go_on, nullptr);
}

bool display_lost() { return lost; }

}  // namespace sparsha::viewer
