#include "app/exploration/exhibits.h"

#include <algorithm>
#include <system_error>

#include "base/error.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;

Exhibits::Exhibits(const std::string& folder, scene::Trust trust, const Terminal& terminal) {
  std::error_code code;
  for (fs::directory_iterator entry(folder, code); !code && entry != fs::directory_iterator(); entry.increment(code)) {
    if (!fs::is_regular_file(entry->path() / "scene.yaml", code)) continue;
    try {
      static_cast<void>(scene::open_scene(entry->path(), trust));
      folders_.push_back(entry->path());
    } catch (const Error& error) {
      terminal.message(std::string("warning: left out of the exhibition: ") + error.what());
    }
  }
  if (folders_.empty()) throw input_error(folder, "there is no scene in this folder", "a folder of scene folders");
  std::ranges::sort(folders_);
}

const fs::path& Exhibits::go(int step) {
  const auto count = static_cast<int>(folders_.size());
  current_ = static_cast<std::size_t>((static_cast<int>(current_) + step + count) % count);
  return current();
}

}  // namespace sparsha::app
