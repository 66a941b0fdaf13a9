// Stages are timed here, so that the report and the terminal agree.
#include "base/threads/progress.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace sparsha {

void Progress::begin(std::string_view stage) {
  throw_if_cancelled();
  const std::lock_guard lock(mutex_);
  end_stage_locked();
  stage_ = stage;
  stage_began_ = std::chrono::steady_clock::now();
  if (listener_) listener_({ProgressUpdate::Kind::stage, stage_, 0.0});
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  end_stage_locked();
}

void Progress::at(double fraction) {
  throw_if_cancelled();
  const std::lock_guard lock(mutex_);
  if (listener_) listener_({ProgressUpdate::Kind::fraction, stage_, std::clamp(fraction, 0.0, 1.0)});
}

void Progress::warn(std::string text) {
  const std::lock_guard lock(mutex_);
  if (std::find(warnings_.begin(), warnings_.end(), text) != warnings_.end()) return;
  warnings_.push_back(std::move(text));
  if (listener_) listener_({ProgressUpdate::Kind::warning, warnings_.back(), 0.0});
}

void Progress::throw_if_cancelled() const {
  if (cancelled()) throw Cancelled();
}

std::vector<StageTime> Progress::stages() const {
  const std::lock_guard lock(mutex_);
  return stages_;
}

std::vector<std::string> Progress::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

void Progress::end_stage_locked() {
  if (stage_.empty()) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - stage_began_;
  stages_.push_back({std::exchange(stage_, {}), elapsed.count()});
}

}  // namespace sparsha
