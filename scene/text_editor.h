// Edits of a YAML text by the places that the reader gives; all else stays as it is written. Seen by scene/ only.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/yaml.h"
#include "scene/config.h"

namespace sparsha::pipeline {

class TextEditor {
 public:
  explicit TextEditor(std::string text);

  // All return false when a place in the text cannot be told.
  bool set_path(const yaml::Node& value, const std::filesystem::path& path);
  /// Replaces the value of a key, in braces, on its line or as a block below it.
  bool set_value(const yaml::Entry& entry, const std::string& value);
  /// A key more in a map that has one already; in a block map below the line of `after`.
  bool add_key(const yaml::Node& map, const yaml::Node& after, const std::string& key, const std::string& value);
  /// An item more at the head of a block sequence.
  bool add_first_item(const yaml::Node& sequence, const std::string& item);
  /// A block at the end.
  void append(const std::string& lines);

  [[nodiscard]] std::string finish();

 private:
  struct Edit {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::string text;
  };
  [[nodiscard]] std::optional<std::size_t> offset(const Place& place) const;
  [[nodiscard]] std::size_t line_end(std::size_t at) const;
  [[nodiscard]] std::size_t after_quoted(std::size_t at) const;
  [[nodiscard]] std::size_t after_braces(std::size_t at) const;

  std::string text_;
  std::vector<std::size_t> starts_;  // of lines
  std::vector<Edit> edits_;
};

/// Where there is no way from the folder to the path (another drive), the path itself.
[[nodiscard]] std::filesystem::path relative_to(const std::filesystem::path& path, const std::filesystem::path& folder);

/// The configuration with absolute paths, as text: equal for configurations that mean the same.
[[nodiscard]] std::string comparable_text(Config config);
/// The paths of a configuration relative to a folder.
void relocate(Config& config, const std::filesystem::path& folder);

}  // namespace sparsha::pipeline
