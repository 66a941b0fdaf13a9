#include "haptics/replay/kept_folder.h"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "scene/folder/folder.h"

namespace sparsha::haptics {
namespace fs = std::filesystem;

namespace {

constexpr const char* kListFile = "recording.yaml";
constexpr const char* kHead =
    "# The scenes of a recording: folder N is what its rows with N in the column scene touch.\n";

std::uint64_t to_number(const std::string& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && std::to_string(number) == text ? number : 0;
}

// A scene as write_scene() leaves it, its description unchanged since.
bool is_as_written(const fs::path& scene, const std::string& sha256) {
  for (const fs::directory_entry& entry : fs::directory_iterator(scene)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() && name != "scene.yaml" && name != "error.tif") return false;  // notes, reports
  }
  scene::require_replaceable(scene, {});
  return sha256_of_file(scene / "scene.yaml") == sha256;
}

}  // namespace

fs::path kept_folder_of(const fs::path& recording) {
  fs::path folder = recording;
  if (folder.extension() == ".csv") folder.replace_extension();
  folder += ".scenes";
  return folder;
}

fs::path kept_scene_folder(const fs::path& kept_folder, std::uint64_t number) {
  return kept_folder / std::to_string(number);
}

fs::path kept_list_of(const fs::path& kept_folder) { return kept_folder / kListFile; }

void write_kept_list(const fs::path& kept_folder, const KeptList& list) {
  std::string text = std::string(kHead) + "recording: " + list.recording_sha256 + "\nscenes:\n";
  for (const auto& [number, sha256] : list.scenes) text += fmt::format("  {}: {}\n", number, sha256);
  write_file(kept_list_of(kept_folder), text);
}

std::optional<KeptList> read_kept_list(const fs::path& kept_folder) {
  const fs::path file = kept_list_of(kept_folder);
  std::error_code code;
  if (!fs::exists(fs::symlink_status(file, code))) return std::nullopt;
  try {
    const yaml::Node root = yaml::parse_file(file);
    yaml::MapReader reader(root, "the scenes of a recording");
    KeptList list;
    list.recording_sha256 = yaml::to_text(reader.required("recording"));
    for (const yaml::Entry& entry : reader.required("scenes").entries) {
      const std::uint64_t number = to_number(entry.key);
      if (number == 0) throw yaml::error_at(entry.value, "no number of a scene", "1 and above");
      list.scenes[number] = yaml::to_text(entry.value);
    }
    reader.finish();
    return list;
  } catch (const Error& error) {  // a damaged list is bad input, not bad usage
    throw Error(ErrorKind::input, error.place(), error.wrong(), error.expected());
  }
}

std::string sha256_of_file(const fs::path& file) {
  const MappedFile mapped(file);
  return mapped.whole([&] { return sha256(mapped.bytes()); });
}

std::string foreign_in_kept_folder(const fs::path& kept_folder) {
  std::error_code code;
  if (!fs::is_directory(fs::symlink_status(kept_folder, code))) return "something else of that name is there";
  try {
    const std::optional<KeptList> list = read_kept_list(kept_folder);
    if (!list) return "a folder of that name is there that no recording has left";
    for (const fs::directory_entry& entry : fs::directory_iterator(kept_folder)) {
      const std::string name = entry.path().filename().string();
      if (name == kListFile && entry.is_regular_file() && !entry.is_symlink()) continue;
      const auto known = list->scenes.find(to_number(name));
      if (known == list->scenes.end() || entry.is_symlink() || !entry.is_directory() ||
          !is_as_written(entry.path(), known->second))
        return "the folder of that name also holds what no recording has left: " + name;
    }
  } catch (const Error& error) {
    return error.wrong();
  } catch (const fs::filesystem_error& error) {
    return "the folder of that name cannot be looked through: " + error.code().message();
  }
  return {};
}

}  // namespace sparsha::haptics
