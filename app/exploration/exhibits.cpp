#include "app/exploration/exhibits.h"

#include <algorithm>
#include <system_error>

#include "base/error.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;

std::vector<std::string> scenes_in(const std::string& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code))
    throw input_error(folder, fs::exists(folder, code) ? "this is no folder" : "the folder does not exist",
                      "a folder of scene folders");
  std::vector<std::string> scenes;
  fs::directory_iterator entry(folder, code);
  for (; !code && entry != fs::directory_iterator(); entry.increment(code)) {
    if (fs::is_regular_file(entry->path() / "scene.yaml", code)) scenes.push_back(entry->path().string());
  }
  std::ranges::sort(scenes);
  return scenes;
}

Exhibits::Exhibits(const std::string& folder, scene::Trust trust, const Terminal& terminal) {
  for (const std::string& scene : scenes_in(folder)) {
    try {
      static_cast<void>(scene::open_scene(scene, trust));
      folders_.emplace_back(scene);
    } catch (const Error& error) {
      terminal.message(std::string("warning: left out of the exhibition: ") + error.what());
    }
  }
  if (folders_.empty()) throw input_error(folder, "there is no scene in this folder", "a folder of scene folders");
}

const fs::path& Exhibits::go(int step) {
  const auto count = static_cast<int>(folders_.size());
  current_ = static_cast<std::size_t>((static_cast<int>(current_) + step + count) % count);
  return current();
}

}  // namespace sparsha::app
