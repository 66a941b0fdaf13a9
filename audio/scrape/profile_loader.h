// Reads the heights under the hand on a thread of its own: a slow disk holds up neither the sound nor its file.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "audio/scrape/profile.h"
#include "haptics/state/state.h"

namespace sparsha::audio {

/// One thread calls wish() and take(), any thread set_scene().
class ProfileLoader {
 public:
  /// `grain`: whether what lies between the nodes is continued.
  ProfileLoader(scene::ScenePointer scene, bool grain);
  /// Waits for the window that is being read.
  ~ProfileLoader();
  ProfileLoader(const ProfileLoader&) = delete;
  ProfileLoader& operator=(const ProfileLoader&) = delete;

  /// After a new depth scan of the same object.
  void set_scene(scene::ScenePointer scene);
  /// What the hand touches now; of several windows that wait only the newest is read. Never waits for the disk.
  void wish(const haptics::State& state);

  struct Loaded {
    std::shared_ptr<const Profile> profile;  ///< null: nothing new
    double since_s = 0.0;                    ///< servo time from which on the hand has been on it
  };
  /// Throws Error{input} when tiles could not be read; then nothing more is read.
  [[nodiscard]] Loaded take();

 private:
  /// What a profile depends on.
  struct Key {
    std::array<std::int64_t, 4> window{};
    std::uint64_t level = 0;
    std::uint64_t flags = 0;  ///< of those that change heights
    double scale = 0.0;
    bool operator==(const Key&) const = default;
  };
  void run();

  ProfileReader reader_;  ///< the thread's
  std::optional<Key> wished_;

  std::mutex mutex_;
  std::condition_variable wake_;
  scene::ScenePointer new_scene_;
  bool again_ = false;  ///< the scene is another one: the same window is read again
  std::optional<haptics::State> waits_;
  Loaded loaded_;
  std::exception_ptr failure_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace sparsha::audio
