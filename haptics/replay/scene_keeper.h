// Keeps the scenes of a recorded run beside its recording, once there is more than one (docs/formats.md).
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/files/files.h"
#include "haptics/replay/kept_folder.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// One thread calls keep(), failure() and finish(); a thread of its own writes. Without finish() nothing is left.
class SceneKeeper {
 public:
  /// `recording` empty or no regular file (a device): nothing is kept. `first` has the number 1 and is written when
  /// another one follows. Throws Error{usage} when it lies where this recording's scenes are kept: they would take its
  /// place.
  SceneKeeper(const std::filesystem::path& recording, scene::ScenePointer first);
  ~SceneKeeper();
  SceneKeeper(const SceneKeeper&) = delete;
  SceneKeeper& operator=(const SceneKeeper&) = delete;

  /// From now on rows may be of `scene`; returns at once. Number 1: another first scene, before any row.
  void keep(std::uint64_t number, scene::ScenePointer scene);
  /// Empty, or why the first scene that cannot be kept cannot be.
  [[nodiscard]] std::string failure() const;
  /// After the recording, whose bytes have this SHA-256 and whose rows are of the scenes `touched`, is in its place:
  /// writes the rest and puts the folder in place of one that an earlier recording of this name has left; after a run
  /// of one scene that one is removed. What no recording has left stays. Throws what failed, for a scene that was
  /// touched: Error{failure} that names the folder.
  void finish(const std::string& recording_sha256, const std::vector<std::uint64_t>& touched);

 private:
  /// When the layers of a scene in a folder were written, and their sizes; empty for a scene in memory.
  using Stamps = std::vector<std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
  struct Job {
    std::uint64_t number = 0;
    scene::ScenePointer scene;
    Stamps stamps;  ///< when it was given
  };
  struct Written {
    std::uint64_t number = 0;
    std::weak_ptr<const scene::Scene> scene;
    std::filesystem::path folder;  ///< that its layers came from; empty: memory
    Stamps stamps;
    std::vector<std::filesystem::path> layers;
  };

  [[nodiscard]] static Stamps stamps_of(const scene::Scene& scene);
  void add(Job job);
  void run();
  void end_thread();
  void write(const Job& job);
  void write_into(const std::filesystem::path& folder, const Job& job);
  void require_kept(const std::vector<std::uint64_t>& touched) const;
  [[nodiscard]] const Written* twin_of(const Written& fresh, const scene::Scene& scene) const;
  [[nodiscard]] bool lies_in_target(const scene::Scene& scene) const;

  std::filesystem::path target_;  ///< empty: nothing is kept
  Job first_;                     ///< until another one follows
  mutable std::mutex mutex_;      ///< of jobs_, stopping_ and failures_
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  bool stopping_ = false;
  std::map<std::uint64_t, std::exception_ptr> failures_;  ///< by the scenes' numbers
  // The writing thread's, and after its end the other's.
  std::unique_ptr<AtomicPath> folder_;
  KeptList list_;
  std::vector<Written> written_;
  scene::ScenePointer last_;  ///< so that an edited scene still knows the one it shares layers with
  std::thread thread_;
};

}  // namespace sparsha::haptics
