// Edits of a YAML text by the places that the reader gives; all else stays as it is written. Seen by scene/ only.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/yaml/yaml.h"
#include "scene/config/parts.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

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
  /// Items more behind the last one, which may be removed at once: below it, in braces on its line.
  bool add_last_items(const yaml::Node& sequence, const std::vector<std::string>& items);
  /// An item less of a block sequence; comments on lines of their own stay.
  bool remove_item(const yaml::Node& sequence, std::size_t item);
  /// All items less of the block sequence that is the key's value: [] is left.
  bool remove_items(const yaml::Entry& entry);
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
  /// Of the lines below `at`'s that are indented deeper than `indent`; comments and empty lines at their end are not.
  [[nodiscard]] std::size_t block_end(std::size_t at, std::size_t indent) const;
  /// Column of the dash before an item of a block sequence; nothing for others.
  [[nodiscard]] std::optional<std::size_t> dash_of(const yaml::Node& item) const;

  std::string text_;
  std::vector<std::size_t> starts_;  // of lines
  std::vector<Edit> edits_;
};

/// Where there is no way from the folder to the path (another drive), the path itself.
[[nodiscard]] std::filesystem::path relative_to(const std::filesystem::path& path, const std::filesystem::path& folder);

/// A part, and its box, as a configuration has them.
[[nodiscard]] std::string part_text(const PartConfig& part);
[[nodiscard]] std::string box_text(const std::array<double, 4>& box_m);

/// The configuration with absolute paths, as text: equal for configurations that mean the same.
[[nodiscard]] std::string comparable_text(Config config);
/// The paths of a configuration relative to a folder.
void relocate(Config& config, const std::filesystem::path& folder);

}  // namespace sparsha::scene
