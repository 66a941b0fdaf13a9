// What SCENE, CONFIG and SCAN arguments mean.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "base/threads/progress.h"
#include "pipeline/build/build.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// True for a file whose ending says YAML.
[[nodiscard]] bool is_config(const std::filesystem::path& path);

/// One configuration file (also a scene's own scene.yaml), or scans to guess one from, in so much memory (0 = no
/// limit), of LAZ perhaps whole chunks alone. Throws Error.
[[nodiscard]] scene::Config config_from(const std::vector<std::string>& arguments,
                                        const std::vector<std::string>& settings, scene::Trust trust,
                                        Progress& progress, std::uint64_t memory_bytes = 0,
                                        bool whole_chunks_only = false);
/// Runs work on `arguments`; an error without a place is told of the first. Where these are scans and nothing was set,
/// nobody asked for what does not fit: Error{usage} becomes Error{input} of the first scan.
template <typename Work>
auto blaming_scans(const std::vector<std::string>& arguments, const std::vector<std::string>& settings,
                   const Work& work) {
  try {
    return work();
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    const bool chosen_for_them = error.kind() == ErrorKind::usage && settings.empty() && !is_config(arguments.front());
    if (!chosen_for_them && !error.place().file.empty()) throw;
    const Place place = error.place().file.empty() ? Place{arguments.front(), 0, 0} : error.place();
    throw Error(chosen_for_them ? ErrorKind::input : error.kind(), place, error.wrong(), error.expected());
  }
}

/// The scene that a configuration describes besides: its folder, or empty for another file.
[[nodiscard]] std::filesystem::path scene_described_by(const std::filesystem::path& config);

/// Throws Error{input} of a folder without a scene, with the scans in it by their names.
[[noreturn]] void refuse_folder(const std::filesystem::path& folder);

/// A scene folder is opened; a configuration or scans are built in memory. Throws Error{usage} for several arguments
/// that are not scans.
[[nodiscard]] scene::ScenePointer scene_from(const std::vector<std::string>& arguments, scene::Trust trust,
                                             Progress& progress);

/// Says that a scene of a whole object is used as its front view alone; `what` names what does so.
void warn_of_front_view(const scene::Scene& scene, const std::string& what, Progress& progress);

/// Before the work: throws Error{usage} when outputs are the same file, or take the place of what `arguments` mean
/// (scenes, a configuration, scans), of a scan, a clip, a picture or any other file that these name, or of one of the
/// other `inputs`; Error{failure} when one cannot be written. `settings` are those of the configuration.
void check_outputs(const std::vector<NamedPath>& outputs, const std::vector<std::string>& arguments,
                   const std::vector<NamedPath>& inputs = {}, const std::vector<std::string>& settings = {});
/// The same of a scene that is open.
void check_outputs(const std::vector<NamedPath>& outputs, const scene::Scene& scene);

/// "1GB", "800 MB", "123456": bytes. Throws Error{usage}.
[[nodiscard]] std::uint64_t parse_bytes(const std::string& text);

/// A SHA-256 of the program's own file: what it keeps for a later run is for no other program.
[[nodiscard]] std::string program_digest();

/// Where results are kept until `result` is whole: .NAME and the ending, in the same folder.
[[nodiscard]] std::filesystem::path hidden_beside(const std::filesystem::path& result, const char* ending);

}  // namespace sparsha::app
