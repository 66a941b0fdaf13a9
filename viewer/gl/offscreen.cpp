// EGL without any surface: Mesa's surfaceless platform first, else the first EGL device that gives a context.
#include "viewer/gl/offscreen.h"

#include <array>
#include <string>
#include <vector>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "base/error.h"

namespace sparsha::viewer::gl {
namespace {

Error failure(const std::string& wrong) {
  return Error(ErrorKind::failure, {}, "no picture can be drawn without a display: " + wrong,
               "EGL with OpenGL 3.3 (package libegl1 with libgl1-mesa-dri)");
}

std::vector<EGLDisplay> candidates() {
  std::vector<EGLDisplay> displays;
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration")) {
    std::array<EGLDeviceEXT, 8> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE)
      for (EGLint i = 0; i < count; ++i)
        displays.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
  }
  return displays;
}

}  // namespace

struct OffscreenContext::Implementation {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  /// False when this display cannot do it; everything is then released again.
  bool open(EGLDisplay candidate, bool debug) {
    if (candidate == EGL_NO_DISPLAY || eglInitialize(candidate, nullptr, nullptr) != EGL_TRUE) return false;
    display = candidate;
    if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE) {
      const std::array<EGLint, 5> wanted{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
      EGLConfig config = nullptr;
      EGLint count = 0;
      if (eglChooseConfig(display, wanted.data(), &config, 1, &count) == EGL_TRUE && count == 1) {
        const std::array<EGLint, 9> attributes{EGL_CONTEXT_MAJOR_VERSION_KHR,
                                               3,
                                               EGL_CONTEXT_MINOR_VERSION_KHR,
                                               3,
                                               EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                                               EGL_CONTEXT_FLAGS_KHR,
                                               debug ? EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR : 0,
                                               EGL_NONE};
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
        if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE)
          return true;
      }
    }
    close();
    return false;
  }

  void close() {
    if (display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    eglTerminate(display);
    display = EGL_NO_DISPLAY;
    context = EGL_NO_CONTEXT;
  }
};

OffscreenContext::OffscreenContext(bool debug) : implementation_(std::make_unique<Implementation>()) {
  const std::vector<EGLDisplay> displays = candidates();
  if (displays.empty()) throw failure("EGL offers neither a surfaceless platform nor a device");
  for (EGLDisplay display : displays)
    if (implementation_->open(display, debug)) return;
  throw failure("no EGL display gives an OpenGL 3.3 core context");
}

OffscreenContext::~OffscreenContext() { implementation_->close(); }

}  // namespace sparsha::viewer::gl
