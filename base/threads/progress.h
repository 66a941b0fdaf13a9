// One object through which long work reports stages, warnings and progress, and is asked to stop.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace sparsha {

/// Name and wall time of a finished stage, seconds.
struct StageTime {
  std::string name;
  double seconds = 0.0;
};

/// What a listener is told. `fraction` is the share of the present stage that is done, 0 to 1.
struct ProgressUpdate {
  enum class Kind { stage, fraction, warning };
  Kind kind = Kind::stage;
  std::string_view text;  ///< stage name or warning
  double fraction = 0.0;
};

/// Thread-safe. The listener is called with a mutex held and must not call back.
class Progress {
 public:
  using Listener = std::function<void(const ProgressUpdate&)>;

  Progress() = default;
  explicit Progress(Listener listener) : listener_(std::move(listener)) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Ends the present stage, if any, and begins the next. Throws Cancelled.
  void begin(std::string_view stage);
  /// Ends the present stage.
  void finish();
  /// Share of the present stage that is done; throws Cancelled, so that loops that report can be stopped.
  void at(double fraction);
  /// A warning for the user and for report.json.
  void warn(std::string text);

  /// Asks the work to stop; safe in a signal handler.
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }
  void throw_if_cancelled() const;

  [[nodiscard]] std::vector<StageTime> stages() const;
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  void end_stage_locked();

  Listener listener_;
  std::atomic<bool> cancelled_{false};
  mutable std::mutex mutex_;
  std::string stage_;
  std::chrono::steady_clock::time_point stage_began_;
  std::vector<StageTime> stages_;
  std::vector<std::string> warnings_;
};

}  // namespace sparsha
