// Which nodes of which level a haptic window is, and loading it off the servo thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <Eigen/Core>

#include "haptics/device/playback/recording.h"
#include "haptics/servo/command.h"
#include "pipeline/scene/scene.h"

namespace sparsha::haptics {

/// Nodes [i0, i0+nx) x [j0, j0+ny) of a level; may reach beyond it.
struct WindowPlan {
  int level = 0;
  int i0 = 0, j0 = 0, nx = 0, ny = 0;
  double scale = 1.0;  ///< device metres per grid metre
  bool texture = true;
  bool friction = true;
};

/// The nodes that a recording was made on.
[[nodiscard]] WindowPlan recorded_plan(const RecordedWindow& recorded);

/// The finest level that fits whole into a window of the configured size; the coarsest when none does.
[[nodiscard]] int overview_level(const pipeline::SceneDescription& scene);

/// The window of a level around a point (grid frame): the whole level when it fits (its own lattice, so that `trace` on
/// the level is the same computation), else levels.window nodes a side. Scale = workspace width / window width.
[[nodiscard]] WindowPlan plan_window(const pipeline::SceneDescription& scene, int level,
                                     const Eigen::Vector2d& centre_m, double workspace_width_m);

/// The middle of a level, grid frame.
[[nodiscard]] Eigen::Vector2d middle_of(const pipeline::Lattice& lattice);

/// Reads the tiles that are needed and makes the surface; centre at the nodes' middle, z of the surface there.
/// Throws Error{input} when tiles cannot be read.
[[nodiscard]] HapticWindow load_window(const pipeline::Scene& scene, const WindowPlan& plan, std::uint64_t id);

/// A window of a recording. Throws Error{input} when the recording was made with another scene.
[[nodiscard]] HapticWindow load_recorded(const pipeline::Scene& scene, const RecordedWindow& recorded);

/// A thread that loads one window after the other.
class WindowLoader {
 public:
  struct Job {
    pipeline::ScenePointer scene;
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
  ~WindowLoader();
  WindowLoader(const WindowLoader&) = delete;
  WindowLoader& operator=(const WindowLoader&) = delete;

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
  std::thread thread_;
};

}  // namespace sparsha::haptics
