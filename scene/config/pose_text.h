// The text of a configuration with other poses: comments and all other keys stay.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// The text of `file` with `poses` of its scans (those that did not change stay as they are written) and with its paths
/// relative to `folder`. `config` is what was read from the file. Where the text cannot be edited (anchors, settings
/// that override it, a scene.yaml), the same configuration without comments. Throws Error{usage}.
[[nodiscard]] std::string text_with_poses(const std::filesystem::path& file, const Config& config,
                                          const std::vector<Eigen::Matrix4d>& poses,
                                          const std::filesystem::path& folder);

}  // namespace sparsha::scene
