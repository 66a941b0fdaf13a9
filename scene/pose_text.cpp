// Edits by the places that the YAML reader gives; the result is read again and compared before it is believed.
#include "scene/pose_text.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/files.h"
#include "base/yaml.h"

namespace sparsha::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostText = 1U << 20U;

struct Edit {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::string text;
};

std::string pose_text(const Eigen::Matrix4d& pose) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(Eigen::Matrix3d(pose.topLeftCorner<3, 3>())).normalized();
  return fmt::format("{{translate: [{}, {}, {}], quaternion: [{}, {}, {}, {}]}}", pose(0, 3), pose(1, 3), pose(2, 3),
                     q.x(), q.y(), q.z(), q.w());
}

// Where there is no way from the folder to the path (another drive), the path itself.
fs::path relative_to(const fs::path& path, const fs::path& folder) {
  std::error_code code;
  const fs::path relative =
      fs::absolute(path, code)
          .lexically_normal()
          .lexically_relative(fs::absolute(folder.empty() ? "." : folder, code).lexically_normal());
  return relative.empty() ? path : relative;
}

class TextEditor {
 public:
  explicit TextEditor(std::string text) : text_(std::move(text)) {
    starts_.push_back(0);
    for (std::size_t k = 0; k < text_.size(); ++k)
      if (text_[k] == '\n') starts_.push_back(k + 1);
  }

  // False when the place of the value cannot be told.
  bool set_path(const yaml::Node& value, const fs::path& path) {
    const std::optional<std::size_t> begin = offset(value.place);
    if (!begin) return false;
    std::size_t end = *begin;
    if (text_[*begin] == '"' || text_[*begin] == '\'') {
      end = after_quoted(*begin);
    } else {
      end += value.scalar.size();
      if (text_.compare(*begin, value.scalar.size(), value.scalar) != 0) return false;
    }
    std::string quoted = "\"";
    for (const char c : path.generic_string()) {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
    edits_.push_back({*begin, end, quoted + '"'});
    return true;
  }

  bool set_pose(const yaml::Node& scan, const std::string& pose) {
    const auto entry =
        std::find_if(scan.entries.begin(), scan.entries.end(), [](const yaml::Entry& e) { return e.key == "pose"; });
    return entry == scan.entries.end() ? add_pose(scan, pose) : replace_pose(*entry, pose);
  }

  [[nodiscard]] std::string finish() {
    std::sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.begin > b.begin; });
    for (const Edit& edit : edits_) text_.replace(edit.begin, edit.end - edit.begin, edit.text);
    return text_;
  }

 private:
  [[nodiscard]] std::optional<std::size_t> offset(const Place& place) const {
    if (place.line < 1 || static_cast<std::size_t>(place.line) > starts_.size()) return std::nullopt;
    const std::size_t at =
        starts_[static_cast<std::size_t>(place.line) - 1] + static_cast<std::size_t>(place.column) - 1;
    return at < text_.size() ? std::optional(at) : std::nullopt;
  }
  [[nodiscard]] std::size_t line_end(std::size_t at) const { return std::min(text_.find('\n', at), text_.size()); }

  [[nodiscard]] std::size_t after_quoted(std::size_t at) const {
    const char quote = text_[at];
    for (++at; at < text_.size(); ++at) {
      if (quote == '"' && text_[at] == '\\') {
        ++at;
      } else if (text_[at] == quote) {
        return at + 1;
      }
    }
    return text_.size();
  }
  [[nodiscard]] std::size_t after_braces(std::size_t at) const {
    int depth = 0;
    while (at < text_.size()) {
      const char c = text_[at];
      if (c == '"' || c == '\'') {
        at = after_quoted(at);
        continue;
      }
      if (c == '{') ++depth;
      if (c == '}' && --depth == 0) return at + 1;
      ++at;
    }
    return text_.size();
  }

  bool replace_pose(const yaml::Entry& entry, const std::string& pose) {
    const std::optional<std::size_t> value = offset(entry.value.place);
    if (value && text_[*value] == '{') {
      edits_.push_back({*value, after_braces(*value), pose});
      return true;
    }
    const std::optional<std::size_t> key = offset(entry.place);
    if (!key) return false;
    // A block: the key's line and those below that are indented deeper.
    const auto indent = static_cast<std::size_t>(entry.place.column) - 1;
    std::size_t end = line_end(*key);
    while (end < text_.size()) {
      const std::size_t begin = end + 1;
      const std::size_t first = text_.find_first_not_of(' ', begin);
      if (first == std::string::npos || first - begin <= indent || text_[first] == '\n') break;
      end = line_end(begin);
    }
    edits_.push_back({*key, end, "pose: " + pose});
    return true;
  }

  bool add_pose(const yaml::Node& scan, const std::string& pose) {
    const std::optional<std::size_t> begin = offset(scan.place);
    const std::optional<std::size_t> file = offset(scan.find("file")->place);
    if (!begin || !file || scan.entries.empty()) return false;
    if (text_[*begin] == '{') {
      edits_.push_back({*begin + 1, *begin + 1, "pose: " + pose + ", "});
      return true;
    }
    const auto indent = static_cast<std::size_t>(scan.entries.front().place.column) - 1;
    const std::size_t end = line_end(*file);
    edits_.push_back({end, end, "\n" + std::string(indent, ' ') + "pose: " + pose});
    return true;
  }

  std::string text_;
  std::vector<std::size_t> starts_;  // of lines
  std::vector<Edit> edits_;
};

std::optional<std::string> edited(const fs::path& file, const Config& wanted, const std::vector<bool>& moved,
                                  const fs::path& folder) {
  const yaml::Node root = yaml::parse_file(file);
  const yaml::Node* scans = root.find("scans");
  if (describes_scene(root) || scans == nullptr || scans->items.size() != wanted.scans.size()) return std::nullopt;
  TextEditor editor(read_file(file, kMostText));
  const bool same_folder = relative_to(file.parent_path() / "x", folder) == "x";
  const auto relocate = [&](const yaml::Node& value) {
    const fs::path path = yaml::to_text(value);
    return same_folder || path.is_absolute() || editor.set_path(value, relative_to(file.parent_path() / path, folder));
  };
  for (std::size_t s = 0; s < wanted.scans.size(); ++s) {
    if (moved[s] && !editor.set_pose(scans->items[s], pose_text(wanted.scans[s].pose))) return std::nullopt;
    if (!relocate(*scans->items[s].find("file"))) return std::nullopt;
  }
  const yaml::Node* audio = root.find("audio");
  const yaml::Node* regions = audio != nullptr && audio->is_map() ? audio->find("regions") : nullptr;
  for (std::size_t k = 0; regions != nullptr && k < regions->items.size(); ++k) {
    const yaml::Node* clip = regions->items[k].is_map() ? regions->items[k].find("clip") : nullptr;
    if (clip != nullptr && !relocate(*clip)) return std::nullopt;
  }
  return editor.finish();
}

// The paths of a configuration made absolute, so that two of them can be compared.
Config comparable(Config config) {
  std::error_code code;
  const auto whole = [&](const fs::path& path) { return fs::absolute(path, code).lexically_normal(); };
  for (ScanConfig& scan : config.scans) scan.file = whole(scan.file);
  if (!config.audio) return config;
  for (AudioRegionConfig& region : config.audio->regions)
    if (auto* clip = std::get_if<fs::path>(&region.sound)) *clip = whole(*clip);
  return config;
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
    return to_yaml(comparable(read)) == to_yaml(comparable(wanted));
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
  const auto relocate = [&](fs::path& path) {
    if (!path.is_absolute()) path = relative_to(path, folder);
  };
  for (ScanConfig& scan : wanted.scans) relocate(scan.file);
  if (wanted.audio) {
    for (AudioRegionConfig& region : wanted.audio->regions)
      if (auto* clip = std::get_if<fs::path>(&region.sound)) relocate(*clip);
  }
  return to_yaml(wanted);
}

}  // namespace sparsha::pipeline
