// The scenes that a recording was made on: the one that is given, or those that were kept beside the recording.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "haptics/replay/recording.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// Scenes by the numbers of a recording's rows. Immutable; never empty.
class RecordedScenes {
 public:
  /// Of a recording that was made on one scene, which has the number 1. Implicit: most recordings are.
  RecordedScenes(scene::ScenePointer only) : by_number_{{1, std::move(only)}} {}  // NOLINT(*-explicit-*)
  RecordedScenes(std::map<std::uint64_t, scene::ScenePointer> by_number, bool of_another_recording)
      : by_number_(std::move(by_number)), of_another_recording_(of_another_recording) {}

  /// That of the lowest number: its configuration was the run's.
  [[nodiscard]] const scene::ScenePointer& first() const { return by_number_.begin()->second; }
  /// That of a window which require() has accepted.
  [[nodiscard]] const scene::ScenePointer& of(const RecordedWindow& window) const {
    return by_number_.at(window.scene);
  }
  [[nodiscard]] const std::map<std::uint64_t, scene::ScenePointer>& by_number() const { return by_number_; }
  /// The scenes were kept with a recording of other bytes, e.g. before rows were cut out of it.
  [[nodiscard]] bool of_another_recording() const { return of_another_recording_; }
  /// Throws Error{input} unless `recording` has windows, and every window lies in a scene that is here.
  void require(const Recording& recording) const;

 private:
  std::map<std::uint64_t, scene::ScenePointer> by_number_;
  bool of_another_recording_ = false;
};

/// The scenes that were kept beside the recording (scene_keeper.h); nothing when it was made on one scene, which is
/// then to be given. For Trust::own_folder none of their files lies outside the folder of the recording's scenes.
/// Throws Error{input} with the folder of a scene that is missing, was changed or cannot be read.
[[nodiscard]] std::optional<RecordedScenes> open_kept_scenes(const Recording& recording, scene::Trust trust);

}  // namespace sparsha::haptics
