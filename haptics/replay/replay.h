// Shows a recorded run in its own time: the second driver of the renderer, beside the servo. No device takes part.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "haptics/replay/recorded_run.h"
#include "haptics/servo/publisher.h"
#include "haptics/servo/servo.h"

namespace sparsha::haptics {

/// One thread calls start(), poll() and stop(); a thread of its own renders one row per recorded period. Where the
/// machine is late, or a window must be loaded, the rest comes later: no row is left out.
class Replay {
 public:
  /// `state` and `recorder` outlive it; `recorder` may be null. Throws Error{input} when the recording was made with
  /// other scenes, or its first window cannot be read.
  Replay(RecordedScenes scenes, std::shared_ptr<const Recording> recording, const RendererOptions& options,
         Seqlock<State>& state, std::vector<std::shared_ptr<ContactQueue>> consumers, RecordSink* recorder);
  ~Replay();
  Replay(const Replay&) = delete;
  Replay& operator=(const Replay&) = delete;

  void start();
  void stop();
  /// Throws Error{input} when the replay has ended because a window could not be read.
  void poll();
  [[nodiscard]] bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t windows_loaded() const noexcept { return windows_.load(std::memory_order_relaxed); }
  /// Only after stop().
  [[nodiscard]] const ServoFigures& figures() const noexcept { return figures_; }

 private:
  void run() noexcept;
  void tick(std::int64_t late_ns) noexcept;

  std::shared_ptr<const Recording> recording_;
  RecordedRun run_;
  Publisher publisher_;
  ServoClock clock_;
  ServoFigures figures_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> finished_{false};
  std::atomic<std::uint64_t> windows_{1};
  std::exception_ptr failure_;  // written before finished_, read after
  std::thread thread_;
};

}  // namespace sparsha::haptics
