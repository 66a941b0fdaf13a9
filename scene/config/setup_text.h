// The text of a configuration with another orientation, other units, another crop and other parts: comments and all
// other keys stay.
#pragma once

#include <filesystem>
#include <string>

#include "scene/scene_fwd.h"

namespace sparsha::scene {

struct SetupText {
  std::string text;
  bool kept = false;  ///< the given text was edited; false: it could not be, and its comments are lost
};

/// `text` is the configuration that `wanted` was made from, with paths relative to `folder`, or empty. Only
/// orientation, units of scans, the first crop filter and the parts (moved, removed, added at the end) are edited;
/// where that does not give `wanted` (anchors, other differences), `wanted` itself without comments.
[[nodiscard]] SetupText text_with_setup(const std::string& text, const Config& wanted,
                                        const std::filesystem::path& folder);

/// Changes every length of a configuration that was guessed from scans in other units. Poses stay.
void scale_lengths(Config& config, double factor);

/// Changes the boxes and polygons of parts alone.
void scale_parts(Config& config, double factor);

}  // namespace sparsha::scene
