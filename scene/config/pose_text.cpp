// Edits by the places that the YAML reader gives; the result is read again and compared before it is used.
#include "scene/config/pose_text.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/files/files.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "scene/config/text_editor.h"

namespace sparsha::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostText = 1U << 20U;

std::string pose_text(const Eigen::Matrix4d& pose) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(Eigen::Matrix3d(pose.topLeftCorner<3, 3>())).normalized();
  return fmt::format("{{translate: [{}, {}, {}], quaternion: [{}, {}, {}, {}]}}", pose(0, 3), pose(1, 3), pose(2, 3),
                     q.x(), q.y(), q.z(), q.w());
}

bool set_pose(TextEditor& editor, const yaml::Node& scan, const std::string& pose) {
  const auto entry =
      std::find_if(scan.entries.begin(), scan.entries.end(), [](const yaml::Entry& e) { return e.key == "pose"; });
  if (entry != scan.entries.end()) return editor.set_value(*entry, pose);
  return editor.add_key(scan, *scan.find("file"), "pose", pose);
}

std::optional<std::string> edited(const fs::path& file, const Config& wanted, const std::vector<bool>& moved,
                                  const fs::path& folder) {
  const yaml::Node root = yaml::parse_file(file);
  const yaml::Node* scans = root.find("scans");
  if (describes_scene(root) || scans == nullptr || scans->items.size() != wanted.scans.size()) return std::nullopt;
  TextEditor editor(read_file(file, kMostText));
  const bool same_folder = relative_to(file.parent_path() / "x", folder) == "x";
  const auto move_path = [&](const yaml::Node& value) {
    const fs::path path = yaml::to_text(value);
    return same_folder || path.is_absolute() || editor.set_path(value, relative_to(file.parent_path() / path, folder));
  };
  for (std::size_t s = 0; s < wanted.scans.size(); ++s) {
    if (moved[s] && !set_pose(editor, scans->items[s], pose_text(wanted.scans[s].pose))) return std::nullopt;
    if (!move_path(*scans->items[s].find("file"))) return std::nullopt;
  }
  const yaml::Node* audio = root.find("audio");
  const yaml::Node* regions = audio != nullptr && audio->is_map() ? audio->find("regions") : nullptr;
  for (std::size_t k = 0; regions != nullptr && k < regions->items.size(); ++k) {
    const yaml::Node* clip = regions->items[k].is_map() ? regions->items[k].find("clip") : nullptr;
    if (clip != nullptr && !move_path(*clip)) return std::nullopt;
  }
  if (const yaml::Node* labels = audio != nullptr && audio->is_map() ? audio->find("labels") : nullptr) {
    const yaml::Node* image = labels->is_map() ? labels->find("file") : labels;
    if (image != nullptr && !move_path(*image)) return std::nullopt;
  }
  return editor.finish();
}

bool says(const std::string& text, const Config& wanted, const fs::path& folder) {
  constexpr double kRounding = 1e-12;
  try {
    Config read = parse_config(yaml::parse_text(text, "the edited configuration"), folder);
    if (read.scans.size() != wanted.scans.size()) return false;
    for (std::size_t s = 0; s < read.scans.size(); ++s) {
      const double size = std::max(1.0, wanted.scans[s].pose.cwiseAbs().maxCoeff());
      if ((read.scans[s].pose - wanted.scans[s].pose).cwiseAbs().maxCoeff() > kRounding * size) return false;
      read.scans[s].pose = wanted.scans[s].pose;
    }
    return comparable_text(read) == comparable_text(wanted);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::string text_with_poses(const fs::path& file, const Config& config, const std::vector<Eigen::Matrix4d>& poses,
                            const fs::path& folder) {
  Config wanted = config;
  std::vector<bool> moved;
  for (std::size_t s = 0; s < poses.size(); ++s) {
    moved.push_back(config.scans[s].pose != poses[s]);
    wanted.scans[s].pose = poses[s];
  }
  if (const std::optional<std::string> text = edited(file, wanted, moved, folder); text && says(*text, wanted, folder))
    return *text;
  relocate(wanted, folder);
  return to_yaml(wanted);
}

}  // namespace sparsha::scene
