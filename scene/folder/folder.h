// What may be done with a scene's folder: replace it, and follow what it names.
#pragma once

#include <filesystem>
#include <vector>

#include "base/files/files.h"
#include "base/threads/progress.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// What people have written on the object, in the frame of its scans (viewer/marks): kept when the scene is built
/// again.
inline constexpr const char* kNotesFile = "notes.yaml";

/// What write_scene() writes besides scene.yaml and clips, relative to the scene's folder.
[[nodiscard]] std::vector<std::filesystem::path> layer_files(const SceneDescription& scene);

/// write_scene() that tells `progress` the share of the present stage that is done. Throws Cancelled besides.
void write_scene(const Scene& scene, const std::filesystem::path& folder, Progress& progress);

/// Writes scene.yaml anew, with all else as it is: for a description whose labels were edited. Throws Error{failure}.
void write_description(const Scene& scene, const std::filesystem::path& folder);

/// Throws Error{usage} unless `folder` is new, empty, or holds what `sparsha build` wrote and nothing else: foreign
/// files are named. So it does for a symbolic link, and for a folder in which a scan of `config` lies. A scene's own
/// clips may lie in it: they are copied into the one that takes its place.
void require_replaceable(const std::filesystem::path& folder, const Config& config);

/// Throws Error{usage} when an output would take the place of a file of the scene in `folder`.
void require_no_scene_file(const std::filesystem::path& folder, const NamedPath& output);

/// Throws Error{input} when a scan that the scene names lies outside its folder and is not, byte for byte, the one it
/// was made from. A scene may come from a stranger, who must not choose which files of this machine are read.
void require_own_scans(const SceneDescription& scene, const std::filesystem::path& folder);

}  // namespace sparsha::scene
