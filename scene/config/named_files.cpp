#include "scene/config/named_files.h"

#include <filesystem>
#include <variant>

namespace sparsha::scene {

std::vector<NamedPath> named_files(const Config& config) {
  std::vector<NamedPath> files;
  for (const ScanConfig& scan : config.scans) files.push_back({"a scan of the scene", scan.file});
  if (!config.audio) return files;
  for (const AudioRegionConfig& region : config.audio->regions) {
    if (const auto* clip = std::get_if<std::filesystem::path>(&region.sound)) files.push_back({"a clip", *clip});
  }
  if (config.audio->labels) files.push_back({"the label image", config.audio->labels->file});
  return files;
}

}  // namespace sparsha::scene
