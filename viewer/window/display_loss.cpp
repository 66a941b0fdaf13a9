// Xlib's two handlers (since libX11 1.7). They are looked up by name, since GLFW need not be built for X.
#include "viewer/window/display_loss.h"

#include <array>
#include <atomic>
#include <mutex>

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

#ifdef __linux__
// Mesa's software driver asks for the size of the window before each picture and takes whatever lies in its variables
// when no answer comes: pictures of thousands of pixels are then written into memory that is not theirs. The linker
// lets drivers find this function before Xlib's (viewer/CMakeLists.txt). Without an answer the size stays what it was.
extern "C" {
using XDrawable = unsigned long;  // NOLINT(google-runtime-int): Xlib's type
// NOLINTBEGIN(readability-identifier-naming): Xlib's name
__attribute__((visibility("default"), used)) int XGetGeometry(void* display, XDrawable drawable, XDrawable* root,
                                                              int* x, int* y, unsigned* width, unsigned* height,
                                                              unsigned* border, unsigned* depth);

int XGetGeometry(void* display, XDrawable drawable, XDrawable* root, int* x, int* y, unsigned* width, unsigned* height,
                 unsigned* border, unsigned* depth) {
  // NOLINTEND(readability-identifier-naming)
  struct Geometry {
    XDrawable drawable = 0, root = 0;
    std::array<int, 2> place{};
    std::array<unsigned, 4> sizes{1, 1, 0, 24};  // width, height, border, depth
  };
  static std::mutex mutex;
  static Geometry last;
  static auto* const ask = reinterpret_cast<decltype(&XGetGeometry)>(
      sparsha::system::symbol(sparsha::system::load_library("libX11.so.6"), "XGetGeometry"));

  Geometry now;
  now.drawable = drawable;
  const int answered = ask == nullptr ? 0
                                      : ask(display, drawable, &now.root, &now.place[0], &now.place[1], &now.sizes[0],
                                            &now.sizes[1], &now.sizes[2], &now.sizes[3]);
  const std::lock_guard lock(mutex);
  if (answered != 0) {
    last = now;
  } else {
    now = last.drawable == drawable ? last : Geometry{};
  }
  *root = now.root;
  *x = now.place[0];
  *y = now.place[1];
  *width = now.sizes[0];
  *height = now.sizes[1];
  *border = now.sizes[2];
  *depth = now.sizes[3];
  return answered;
}
}
#endif
