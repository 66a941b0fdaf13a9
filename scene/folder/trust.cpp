// Which files of this machine a scene may name.
#include "base/error.h"
#include "base/files/files.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace fs = std::filesystem;

void require_own_scans(const SceneDescription& scene, const fs::path& folder) {
  std::error_code code;
  for (std::size_t i = 0; i < scene.config.scans.size(); ++i) {
    const fs::path& file = scene.config.scans[i].file;
    if (lies_within(file, folder) || !fs::exists(file, code)) continue;
    const auto refuse = [&](const char* wrong) {
      throw input_error(file.string(), wrong, "--trust, if you know where the scene comes from");
    };
    if (!fs::is_regular_file(file, code)) refuse("the scene names it as a scan, and it is no file");
    const MappedFile mapped(file);
    const bool same =
        i < scene.sources.size() && mapped.whole([&] { return sha256(mapped.bytes()); }) == scene.sources[i].sha256;
    if (!same) refuse("outside the scene's folder, and not the scan that the scene was made from");
  }
}

}  // namespace sparsha::scene
