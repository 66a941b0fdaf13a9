#include "scene/title.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "scene/scene.h"

namespace sparsha::scene {

std::string title_of(const SceneDescription& description, std::filesystem::path folder) {
  if (folder.filename().empty()) folder = folder.parent_path();
  std::string name = (folder.extension() == ".scene" ? folder.stem() : folder.filename()).string();
  const auto& sources = description.sources;
  if ((name.empty() || name == "scene" || name == "." || name == "..") && !sources.empty()) {
    name = sources.front().file.stem().string();
    if (sources.size() > 1) name += fmt::format(" and {} more", sources.size() - 1);
  }
  std::ranges::replace(name, '_', ' ');
  std::ranges::replace(name, '-', ' ');
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

}  // namespace sparsha::scene
