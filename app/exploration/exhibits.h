// The scenes of an exhibition, one after the other.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "app/terminal/terminal.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// The folders in `folder` that hold a scene.yaml, by name. Throws Error{input} when there is no such folder.
[[nodiscard]] std::vector<std::string> scenes_in(const std::string& folder);

class Exhibits {
 public:
  /// None.
  Exhibits() = default;
  /// The folders in `folder` that hold scenes, by name; one that cannot be opened is left out with a warning. Throws
  /// Error{input} when there is none.
  Exhibits(const std::string& folder, scene::Trust trust, const Terminal& terminal);

  [[nodiscard]] bool empty() const { return folders_.empty(); }
  [[nodiscard]] std::size_t size() const { return folders_.size(); }
  [[nodiscard]] const std::filesystem::path& current() const { return folders_[current_]; }
  /// `step` -1 or 1: the one before or after, in a circle.
  const std::filesystem::path& go(int step);

 private:
  std::vector<std::filesystem::path> folders_;
  std::size_t current_ = 0;
};

}  // namespace sparsha::app
