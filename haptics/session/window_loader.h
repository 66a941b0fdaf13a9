// Loading windows off the servo thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/threads/progress.h"
#include "haptics/servo/command.h"
#include "haptics/window/window.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// A thread that loads one window after the other.
class WindowLoader {
 public:
  struct Job {
    scene::ScenePointer scene;
    std::uint64_t scene_number = 1;  ///< becomes HapticWindow::scene
    WindowPlan plan;
    Command command;  ///< gets the window when it is loaded
    std::uint64_t id = 0;
  };
  struct Result {
    Job job;
    double seconds = 0.0;
    std::string error;  ///< empty when loaded
  };

  WindowLoader();
  /// Cancels the load at work and waits for its end.
  ~WindowLoader();
  WindowLoader(const WindowLoader&) = delete;
  WindowLoader& operator=(const WindowLoader&) = delete;

  /// Jobs that wait and whose view the new one leaves nothing of are dropped.
  void request(Job job);
  [[nodiscard]] std::optional<Result> take();
  /// Jobs that have been requested and not yet taken.
  [[nodiscard]] bool busy() const;

 private:
  void run();

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  std::deque<Result> results_;
  bool working_ = false;
  bool stopping_ = false;
  Progress progress_;
  std::thread thread_;
};

}  // namespace sparsha::haptics
