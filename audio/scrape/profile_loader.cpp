#include "audio/scrape/profile_loader.h"

#include <utility>

#include "scene/scene.h"

namespace sparsha::audio {

ProfileLoader::ProfileLoader(scene::ScenePointer scene, bool grain)
    : reader_(std::move(scene), grain), thread_([this] { run(); }) {}

ProfileLoader::~ProfileLoader() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ProfileLoader::set_scene(scene::ScenePointer scene) {
  const std::lock_guard lock(mutex_);
  new_scene_ = std::move(scene);
  again_ = true;
}

void ProfileLoader::wish(const haptics::State& state) {
  constexpr std::uint64_t kHeights =
      haptics::kFlagTexture | haptics::kFlagFalls | haptics::kFlagRim | haptics::kFlagAround;
  const Key key{state.window, state.level, state.flags & kHeights, state.scale};
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(again_, false) && wished_ == key) return;
    wished_ = key;
    waits_ = state;
  }
  wake_.notify_all();
}

ProfileLoader::Loaded ProfileLoader::take() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(loaded_, {});
}

void ProfileLoader::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || waits_; });
    if (stopping_) return;
    const haptics::State state = *std::exchange(waits_, std::nullopt);
    if (new_scene_) reader_.set_scene(std::exchange(new_scene_, nullptr));
    lock.unlock();
    std::shared_ptr<const Profile> profile;
    std::exception_ptr failure;
    try {
      profile = reader_.update(state);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (profile) loaded_ = {std::move(profile), state.time_s};
    if (!failure) continue;
    failure_ = failure;
    return;
  }
}

}  // namespace sparsha::audio
