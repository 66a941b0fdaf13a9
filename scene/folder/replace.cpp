// Whose files stand in a folder that a scene is to be written to.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "scene/folder/folder.h"
#include "scene/folder/layers.h"

namespace sparsha::scene {
namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedy = "a new folder, an empty one or a scene that sparsha build wrote";

// write_scene(), write_report() and the viewer write these; a test builds a scene with all of them and replaces it.
constexpr std::array<std::string_view, 15> kTopFiles = {"scene.yaml", "report.json", "report.html",  "relief.png",
                                                        "height.png", "texture.png", "friction.png", "coverage.png",
                                                        "error.png",  "filters.png", "around.png",   "sides.png",
                                                        "error.tif",  "charts.bin",  kNotesFile};

bool is_layer_file(const std::string& name) {
  if (name == "height.tif" || name == "height.tfw" || name == "level.vrt" || name == "mask.tif" || name == "colour.tif")
    return true;
  return std::any_of(kFloatLayers.begin(), kFloatLayers.end(),
                     [&](const OptionalLayer& layer) { return name == std::string(layer.name) + ".tif"; });
}

bool is_level_folder(std::string_view name) {
  constexpr std::string_view kLevel = "level-";
  if (!name.starts_with(kLevel)) return false;
  name.remove_prefix(kLevel.size());
  return !name.empty() && name.find_first_not_of("0123456789") == std::string_view::npos;
}

// The clips and the label image that the scene in a folder names, relative to it.
std::set<fs::path> clips_of(const yaml::Node& scene) {
  std::set<fs::path> clips;
  const yaml::Node* audio = scene.find("audio");
  const yaml::Node* labels = audio != nullptr ? audio->find("labels") : nullptr;
  const yaml::Node* image = labels != nullptr ? labels->find("file") : nullptr;
  if (image != nullptr) clips.insert(fs::path(image->scalar).lexically_normal());
  const yaml::Node* regions = audio != nullptr ? audio->find("regions") : nullptr;
  if (regions == nullptr) return clips;
  for (const yaml::Node& region : regions->items) {
    if (const yaml::Node* clip = region.find("clip")) clips.insert(fs::path(clip->scalar).lexically_normal());
  }
  return clips;
}

// True for what `relative`, below a scene's folder, is when Sparsha wrote it.
bool is_ours(const fs::directory_entry& entry, const fs::path& relative, const std::set<fs::path>& clips) {
  if (entry.is_symlink()) return false;
  const std::string name = relative.filename().string();
  const std::string parent = relative.parent_path().string();
  if (entry.is_directory()) return parent.empty() && (is_level_folder(name) || name == "audio");
  if (!entry.is_regular_file()) return false;
  if (parent.empty()) return std::find(kTopFiles.begin(), kTopFiles.end(), name) != kTopFiles.end();
  return (is_level_folder(parent) && is_layer_file(name)) || clips.contains(relative);
}

std::vector<std::string> foreign_entries(const fs::path& folder, const yaml::Node& scene) {
  const std::set<fs::path> clips = clips_of(scene);
  std::vector<std::string> foreign;
  std::error_code code;
  fs::recursive_directory_iterator entry(folder, code);
  for (; !code && entry != fs::recursive_directory_iterator(); entry.increment(code)) {
    const fs::path relative = entry->path().lexically_relative(folder);
    if (is_ours(*entry, relative, clips)) continue;
    foreign.push_back(relative.generic_string());
    if (entry->is_directory()) entry.disable_recursion_pending();
  }
  if (code)
    throw usage_error("the folder " + folder.string() + " cannot be looked through: " + code.message(), kRemedy);
  std::sort(foreign.begin(), foreign.end());
  return foreign;
}

std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMost); ++k) text += (k > 0 ? ", " : "") + names[k];
  return names.size() > kMost ? text + fmt::format(" and {} more", names.size() - kMost) : text;
}

yaml::Node scene_in(const fs::path& folder) {
  const std::string what = "the folder " + folder.string();
  std::error_code code;
  if (!fs::exists(folder / "scene.yaml", code)) throw usage_error(what + " holds something else than a scene", kRemedy);
  yaml::Node root;
  try {
    root = yaml::parse_file(folder / "scene.yaml");
  } catch (const Error&) {
    throw usage_error(what + " holds a scene.yaml that cannot be read", kRemedy);
  }
  if (!describes_scene(root)) {
    throw usage_error(what + " holds a scene.yaml that sparsha build did not write", kRemedy);
  }
  return root;
}

}  // namespace

void require_no_scene_file(const fs::path& folder, const NamedPath& output) {
  std::error_code code;
  if (output.path.empty() || !fs::is_regular_file(output.path, code) || !lies_within(output.path, folder)) return;
  const fs::path relative = fs::canonical(output.path, code).lexically_relative(fs::canonical(folder, code));
  if (!is_ours(fs::directory_entry(output.path), relative, clips_of(yaml::parse_file(folder / "scene.yaml")))) return;
  throw usage_error(output.name + " " + output.path.string() + " is a file of the scene", "another name");
}

void require_replaceable(const fs::path& folder, const Config& config) {
  fs::path target = folder;
  while (target.has_relative_path() && target.filename().empty()) target = target.parent_path();
  std::error_code code;
  if (fs::is_symlink(fs::symlink_status(target, code))) {
    throw usage_error(target.string() + " is a symbolic link", "the folder itself, or a new one");
  }
  if (!fs::exists(target, code)) return;
  if (!fs::is_directory(target, code)) throw usage_error(target.string() + " is no folder", kRemedy);
  if (fs::is_empty(target, code)) return;
  for (const ScanConfig& scan : config.scans) {
    if (!lies_within(scan.file, target)) continue;
    throw usage_error(
        "the scan " + scan.file.string() + " lies in the folder that the scene would replace, " + target.string(),
        "another output folder");
  }
  const yaml::Node scene = scene_in(target);
  const std::vector<std::string> foreign = foreign_entries(target, scene);
  if (foreign.empty()) return;
  throw usage_error(
      "the scene folder " + target.string() + " also holds what sparsha build did not write: " + some_of(foreign),
      "another output folder, or these files elsewhere");
}

}  // namespace sparsha::scene
