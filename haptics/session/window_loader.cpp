#include "haptics/session/window_loader.h"

#include <chrono>
#include <utility>

namespace sparsha::haptics {

WindowLoader::WindowLoader() : thread_([this] { run(); }) {}

WindowLoader::~WindowLoader() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  progress_.cancel();
  wake_.notify_all();
  thread_.join();
}

void WindowLoader::request(Job job) {
  {
    const std::lock_guard lock(mutex_);
    // A window comes to a place of its own or stays under the hand: only the former matters to what follows it.
    const bool own_place = job.command.move;
    std::erase_if(jobs_, [&](const Job& waiting) { return own_place || !waiting.command.move; });
    jobs_.push_back(std::move(job));
  }
  wake_.notify_one();
}

std::optional<WindowLoader::Result> WindowLoader::take() {
  const std::lock_guard lock(mutex_);
  if (results_.empty()) return std::nullopt;
  Result result = std::move(results_.front());
  results_.pop_front();
  return result;
}

bool WindowLoader::busy() const {
  const std::lock_guard lock(mutex_);
  return working_ || !jobs_.empty() || !results_.empty();
}

void WindowLoader::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (stopping_) return;
    Result result;
    result.job = std::move(jobs_.front());
    jobs_.pop_front();
    working_ = true;
    lock.unlock();
    const auto begun = std::chrono::steady_clock::now();
    try {
      result.job.command.window = load_window(*result.job.scene, result.job.plan, result.job.id, &progress_);
      result.job.command.window.scene = result.job.scene_number;
    } catch (const std::exception& error) {
      result.error = error.what();
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    lock.lock();
    working_ = false;
    results_.push_back(std::move(result));
  }
}

}  // namespace sparsha::haptics
