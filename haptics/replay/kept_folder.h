// The folder beside a recording that holds its scenes, and the file in it that tells whose it is (docs/formats.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace sparsha::haptics {

/// recording.yaml: what a run has kept.
struct KeptList {
  std::string recording_sha256;                 ///< of run.csv
  std::map<std::uint64_t, std::string> scenes;  ///< number -> SHA-256 of its scene.yaml
};

/// run.csv -> run.scenes; any other name gets the ending added.
[[nodiscard]] std::filesystem::path kept_folder_of(const std::filesystem::path& recording);
/// The scene folder of a number in it.
[[nodiscard]] std::filesystem::path kept_scene_folder(const std::filesystem::path& kept_folder, std::uint64_t number);
/// The file with the list.
[[nodiscard]] std::filesystem::path kept_list_of(const std::filesystem::path& kept_folder);

/// Throws Error{failure}.
void write_kept_list(const std::filesystem::path& kept_folder, const KeptList& list);
/// Nothing when there is no list. Throws Error{input} when it cannot be read.
[[nodiscard]] std::optional<KeptList> read_kept_list(const std::filesystem::path& kept_folder);
/// SHA-256 of a file of the user's. Throws Error{input}.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

/// Empty when the folder holds what a run has kept and nothing else, so that it may be removed; else what speaks
/// against it: another kind of file, an entry that no run has written, a scene that was edited.
[[nodiscard]] std::string foreign_in_kept_folder(const std::filesystem::path& kept_folder);

}  // namespace sparsha::haptics
