// An OpenGL 3.3 core context without a display (EGL, surfaceless), current on the calling thread while it exists.
#pragma once

#include <memory>

namespace sparsha::viewer::gl {

class OffscreenContext {
 public:
  /// `debug` asks the driver for error messages. Throws Error{failure} when no such context can be made.
  explicit OffscreenContext(bool debug = false);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::viewer::gl
