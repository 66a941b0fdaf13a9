// The engine that a run is heard through; another one takes its place when the scene changes.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "audio/engine.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// speak() from any thread; all else from the one that runs the session. Without an engine every call does nothing.
class LiveSound {
 public:
  /// Ends the engine before.
  void use(std::unique_ptr<audio::Engine> engine);
  [[nodiscard]] bool present() const { return engine_ != nullptr; }
  void start();
  /// See audio::Engine::stop().
  void stop();
  void set_scene(const scene::ScenePointer& scene);
  [[nodiscard]] std::uint64_t strikes() const { return engine_ ? engine_->strikes() : 0; }
  /// False when no stream plays.
  bool speak(const std::vector<float>& words, double rate_hz);
  /// A warning of the engine that has not been returned before, or empty.
  [[nodiscard]] std::string take_warning();

 private:
  std::unique_ptr<audio::Engine> engine_;
  std::mutex mutex_;  // of engine_ between use() and speak()
  std::string warning_;
};

}  // namespace sparsha::app
