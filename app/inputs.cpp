// Turns SCENE, CONFIG and SCAN arguments into configurations and scenes.
#include "app/inputs.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

#include "base/error.h"
#include "base/system/process.h"
#include "pipeline/scan/companions.h"
#include "pipeline/scan/named_file.h"
#include "pipeline/suggest/suggest.h"
#include "scene/config/named_files.h"
#include "scene/config/override.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;

bool is_config(const fs::path& path) { return path.extension() == ".yaml" || path.extension() == ".yml"; }

fs::path scene_described_by(const fs::path& config) {
  std::error_code code;
  if (config.filename() != "scene.yaml" || !scene::describes_scene(yaml::parse_file(config))) return {};
  return fs::canonical(config.has_parent_path() ? config.parent_path() : fs::path("."), code);
}

scene::Config config_from(const std::vector<std::string>& arguments, const std::vector<std::string>& settings,
                          scene::Trust trust, Progress& progress, std::uint64_t memory_bytes, bool whole_chunks_only) {
  const bool any = std::any_of(arguments.begin(), arguments.end(), [](const std::string& a) { return is_config(a); });
  if (any) {
    if (arguments.size() > 1) throw usage_error("a configuration and something else", "one CONFIG, or SCANs only");
    if (const fs::path folder = scene_described_by(arguments.front()); !folder.empty()) {
      const scene::ScenePointer scene = scene::open_scene(folder, trust);
      if (trust == scene::Trust::own_folder) scene::require_own_scans(scene->description(), folder);
    }
    return scene::load_config(arguments.front(), settings);
  }
  std::error_code code;
  for (const std::string& argument : arguments)
    if (const fs::path own = fs::path(argument) / "scene.yaml"; fs::is_regular_file(own, code))
      throw input_error(argument, "this is the folder of a scene, and no scan",
                        own.string() + ", which builds the scene again");
  const std::vector<fs::path> scans(arguments.begin(), arguments.end());
  pipeline::SuggestOptions options;
  options.memory_bytes = memory_bytes;
  options.settings_follow = !settings.empty();
  options.whole_chunks_only = whole_chunks_only;
  pipeline::Suggestion suggestion =
      blaming_scans(arguments, {}, [&] { return pipeline::suggest_config(scans, {}, progress, options); });
  if (settings.empty()) return std::move(suggestion.config);
  yaml::Node root = yaml::parse_text(suggestion.yaml, "the suggested configuration");
  scene::override_keys(root, settings);
  return scene::parse_config(root, {});
}

void refuse_folder(const fs::path& folder) {
  const std::string scans = pipeline::scans_in(folder);
  throw input_error(folder.string(), "there is no scene.yaml in it",
                    "a scene folder written by sparsha build" +
                        (scans.empty() ? std::string() : ", or the scans in it by their names: " + scans));
}

scene::ScenePointer scene_from(const std::vector<std::string>& arguments, scene::Trust trust, Progress& progress) {
  std::error_code code;
  for (const std::string& argument : arguments) {
    const bool folder = fs::is_directory(argument, code);
    if (folder && arguments.size() > 1) throw usage_error("a scene and something else", "one SCENE, or SCANs only");
    if (folder && !fs::exists(fs::path(argument) / "scene.yaml", code)) refuse_folder(argument);
    if (folder) return scene::open_scene(argument, trust);
    pipeline::require_file_name(argument);
    if (!fs::exists(argument, code)) {
      throw input_error(argument, "no such file or folder", "a scene folder, a configuration or scans");
    }
  }
  if (arguments.size() == 1 && fs::path(arguments.front()).filename() == "scene.yaml") {
    return scene::open_scene(fs::path(arguments.front()).parent_path(), trust);
  }
  const scene::Config config = config_from(arguments, {}, trust, progress);
  return blaming_scans(arguments, {}, [&] { return pipeline::build_scene(config, {}, progress).scene; });
}

void warn_of_front_view(const scene::Scene& scene, const std::string& what, Progress& progress) {
  if (scene.description().charts == nullptr) return;
  progress.warn("the scene has the whole object; " + what + " uses its front view alone");
}

namespace {

// Nothing for what cannot be read: that is said when it is opened, as bad input.
std::vector<NamedPath> files_named_in(const fs::path& config, const std::vector<std::string>& settings) {
  try {
    return scene::named_files(scene::load_config(config, settings));
  } catch (const Error&) {
    return {};
  }
}

/// Of whatever scene: also of one that was written from the scene in memory that is exported.
void require_no_file_of_a_scene(const NamedPath& output) {
  std::error_code code;
  if (!fs::is_regular_file(output.path, code)) return;
  const fs::path place = fs::canonical(output.path, code);
  for (const fs::path& folder : {place.parent_path(), place.parent_path().parent_path()}) {
    try {
      if (fs::is_regular_file(folder / "scene.yaml", code) && !scene_described_by(folder / "scene.yaml").empty())
        scene::require_no_scene_file(folder, output);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::usage && error.place().file.empty()) throw;  // else a scene.yaml that is none
    }
  }
}

void require_harmless(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& known) {
  require_distinct(outputs, known);
  for (const NamedPath& output : outputs) {
    if (output.path.empty()) continue;
    if (output.path == "-")
      throw usage_error(output.name + " -: results are written to files",
                        "a name; /dev/stdout is standard output, and ./- a file called so");
    require_no_file_of_a_scene(output);
    for (const NamedPath& input : known) {
      if (!pipeline::has_ending_of_scan(input.path) || !pipeline::names_companion(input.path, output.path)) continue;
      throw usage_error(
          output.name + " " + output.path.string() + " is a file that the scan " + input.path.string() + " names",
          "another name");
    }
    require_writable(output.path);
  }
}

}  // namespace

void check_outputs(const std::vector<NamedPath>& outputs, const std::vector<std::string>& arguments,
                   const std::vector<NamedPath>& inputs, const std::vector<std::string>& settings) {
  std::error_code code;
  std::vector<NamedPath> known = inputs;
  for (const std::string& argument : arguments) {
    known.push_back({"the input", argument});
    const bool config = is_config(argument) && fs::is_regular_file(argument, code);
    const fs::path folder = fs::is_directory(argument, code) ? fs::path(argument)
                            : config                         ? scene_described_by(argument)
                                                             : fs::path();
    if (!folder.empty() || config) {
      const auto named = files_named_in(folder.empty() ? fs::path(argument) : folder / "scene.yaml", settings);
      known.insert(known.end(), named.begin(), named.end());
    }
  }
  require_harmless(outputs, known);
}

void check_outputs(const std::vector<NamedPath>& outputs, const scene::Scene& scene) {
  require_harmless(outputs, scene::named_files(scene.description().config));
}

std::uint64_t parse_bytes(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  std::erase(unit, ' ');
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::toupper(c); });
  double factor = 0.0;
  if (unit.empty() || unit == "B") factor = 1.0;
  if (unit == "KB" || unit == "K") factor = 1e3;
  if (unit == "MB" || unit == "M") factor = 1e6;
  if (unit == "GB" || unit == "G") factor = 1e9;
  if (unit == "TB" || unit == "T") factor = 1e12;
  if (unit == "KIB") factor = 1024.0;
  if (unit == "MIB") factor = 1048576.0;
  if (unit == "GIB") factor = 1073741824.0;
  if (unit == "TIB") factor = 1099511627776.0;
  const double bytes = value * factor;
  if (error != std::errc{} || !(bytes >= 1.0) || bytes > 1e15) {
    throw usage_error("'" + text + "' is not an amount of memory", "e.g. 1GB or 800MB");
  }
  return static_cast<std::uint64_t>(bytes);
}

std::string program_digest() {
  constexpr std::size_t kMostBytes = std::size_t{1} << 30U;  // the program is 15 MB
  return sha256(std::as_bytes(std::span<const char>(read_file(system::program_file(), kMostBytes))));
}

fs::path hidden_beside(const fs::path& result, const char* ending) {
  return result.parent_path() / ("." + result.filename().string() + ending);
}

}  // namespace sparsha::app
