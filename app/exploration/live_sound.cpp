#include "app/exploration/live_sound.h"

#include <utility>

#include "scene/scene.h"

namespace sparsha::app {

void LiveSound::use(std::unique_ptr<audio::Engine> engine) {
  const std::lock_guard lock(mutex_);
  engine_ = std::move(engine);
}

void LiveSound::start() {
  if (engine_) engine_->start();
}

void LiveSound::stop() {
  if (engine_) engine_->stop();
}

void LiveSound::set_scene(const scene::ScenePointer& scene) {
  if (engine_) engine_->set_scene(scene);
}

bool LiveSound::speak(const std::vector<float>& words, double rate_hz) {
  const std::lock_guard lock(mutex_);
  return engine_ && engine_->speak(words, rate_hz);
}

std::string LiveSound::take_warning() {
  if (!engine_ || engine_->warning() == warning_) return {};
  return warning_ = engine_->warning();
}

}  // namespace sparsha::app
