// What a scene is called where it is shown: in the window and on its report.
#pragma once

#include <filesystem>
#include <string>

#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// The name of the scene's folder without the ending .scene, when it says something; else of its scan, and of several
/// "First scan and 2 more". Underscores and hyphens are blanks, and it begins with a capital. Empty when nothing is
/// known.
[[nodiscard]] std::string title_of(const SceneDescription& description, std::filesystem::path folder = {});

}  // namespace sparsha::scene
