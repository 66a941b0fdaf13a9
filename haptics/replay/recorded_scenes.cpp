#include "haptics/replay/recorded_scenes.h"

#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"
#include "haptics/replay/kept_folder.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace fs = std::filesystem;

namespace {

bool fits(const WindowPlan& plan, const scene::SceneDescription& scene) {
  const auto level = static_cast<std::size_t>(plan.level);
  if (plan.level < 0 || level >= scene.levels.size() || plan.nx < 2 || plan.ny < 2) return false;
  if (plan.around && scene.charts == nullptr) return false;
  const int beyond = 2 * scene::fall_nodes(scene::beyond_of(scene, view_of(plan)));
  return plan.nx <= scene.levels[level].nx + beyond && plan.ny <= scene.levels[level].ny + beyond;
}

bool names(const KeptList& list, const Recording& recording) {
  return list.recording_sha256 == sha256_of_file(recording.file());
}

/// Whether the folder's list names the recording, byte for byte. What cannot be read names nothing.
bool belongs_to(const fs::path& kept_folder, const Recording& recording) {
  try {
    const std::optional<KeptList> list = read_kept_list(kept_folder);
    return list && names(*list, recording);
  } catch (const Error&) {
    return false;
  }
}

void require_within(const fs::path& path, const fs::path& folder) {
  if (lies_within(path, folder)) return;
  throw input_error(path.string(), "the recording's scene lies outside the folder of the recording",
                    "scenes that lie beside it; --trust, if you know where it comes from");
}

scene::ScenePointer open_kept(const fs::path& folder, std::uint64_t number, const KeptList& list, scene::Trust trust) {
  std::error_code code;
  if (!fs::is_directory(folder, code))
    throw input_error(folder.string(), "the scene that the recording was made on is not there",
                      "the folder " + folder.parent_path().filename().string() +
                          " beside the recording, as `explore "
                          "--record` left it");
  scene::ScenePointer scene = scene::open_scene(folder, trust);
  const auto listed = list.scenes.find(number);
  if (listed != list.scenes.end() && sha256_of_file(folder / "scene.yaml") != listed->second)
    throw input_error((folder / "scene.yaml").string(), "the scene was changed after the recording was made",
                      "the scene as `explore --record` left it");
  return scene;
}

}  // namespace

void RecordedScenes::require(const Recording& recording) const {
  if (recording.windows().empty())
    throw Error(ErrorKind::input, {}, "the path does not say on which windows it was made",
                "a run.csv as `explore --record` writes it");
  for (const RecordedWindow& window : recording.windows()) {
    const auto scene = by_number_.find(window.scene);
    if (scene != by_number_.end() && fits(window.plan, scene->second->description())) continue;
    const fs::path folder = scene != by_number_.end() ? scene->second->folder() : fs::path();
    throw Error(ErrorKind::input, {folder.string()}, "the recording was made with another scene",
                "the scene that it was made with");
  }
}

std::optional<RecordedScenes> open_kept_scenes(const Recording& recording, scene::Trust trust) {
  std::set<std::uint64_t> numbers;
  for (const RecordedWindow& window : recording.windows()) numbers.insert(window.scene);
  if (numbers.empty()) return std::nullopt;
  const fs::path kept = kept_folder_of(recording.file());
  // The run may have ended before the first row on its second scene.
  if (numbers == std::set<std::uint64_t>{1} && !belongs_to(kept, recording)) return std::nullopt;
  numbers.insert(1);  // whose configuration was the run's
  const bool own = trust == scene::Trust::own_folder;
  const fs::path beside = recording.file().has_parent_path() ? recording.file().parent_path() : fs::path(".");
  if (own) require_within(kept, beside);
  if (own) require_within(kept_list_of(kept), beside);
  const std::optional<KeptList> found = read_kept_list(kept);  // none: the run was killed
  const KeptList list = found.value_or(KeptList{});
  std::map<std::uint64_t, scene::ScenePointer> scenes;
  for (const std::uint64_t number : numbers) {
    const fs::path folder = kept_scene_folder(kept, number);
    if (own) require_within(folder, beside);
    scenes[number] = open_kept(folder, number, list, trust);
  }
  return RecordedScenes(std::move(scenes), found && !names(list, recording));
}

}  // namespace sparsha::haptics
