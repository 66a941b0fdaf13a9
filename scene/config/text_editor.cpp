// Places of the reader to offsets in the text.
#include "scene/config/text_editor.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "base/files/paths.h"
#include "base/yaml/yaml_text.h"
#include "scene/config/config.h"

namespace sparsha::scene {
namespace fs = std::filesystem;

fs::path relative_to(const fs::path& path, const fs::path& folder) { return path_from(folder, path); }

namespace {

/// Calls `use` with every file that a configuration names.
template <class Use>
void for_each_file(Config& config, const Use& use) {
  for (ScanConfig& scan : config.scans) use(scan.file);
  if (!config.audio) return;
  for (AudioRegionConfig& region : config.audio->regions)
    if (auto* clip = std::get_if<fs::path>(&region.sound)) use(*clip);
  if (config.audio->labels) use(config.audio->labels->file);
}

}  // namespace

std::string comparable_text(Config config) {
  std::error_code code;
  for_each_file(config, [&](fs::path& path) { path = without_dots(fs::absolute(path, code)); });
  return to_yaml(config);
}

void relocate(Config& config, const fs::path& folder) {
  for_each_file(config, [&](fs::path& path) {
    if (!path.is_absolute()) path = relative_to(path, folder);
  });
}

TextEditor::TextEditor(std::string text) : text_(std::move(text)) {
  starts_.push_back(0);
  for (std::size_t k = 0; k < text_.size(); ++k)
    if (text_[k] == '\n') starts_.push_back(k + 1);
}

bool TextEditor::set_path(const yaml::Node& value, const fs::path& path) {
  const std::optional<std::size_t> begin = offset(value.place);
  if (!begin) return false;
  std::size_t end = *begin;
  if (text_[*begin] == '"' || text_[*begin] == '\'') {
    end = after_quoted(*begin);
  } else {
    end += value.scalar.size();
    if (text_.compare(*begin, value.scalar.size(), value.scalar) != 0) return false;
  }
  edits_.push_back({*begin, end, yaml::quoted(path.generic_string())});
  return true;
}

bool TextEditor::set_value(const yaml::Entry& entry, const std::string& value) {
  const std::optional<std::size_t> begin = offset(entry.value.place);
  if (begin && (text_[*begin] == '{' || text_[*begin] == '[')) {
    edits_.push_back({*begin, after_braces(*begin), value});
    return true;
  }
  if (begin && entry.value.is_scalar() && text_.compare(*begin, entry.value.scalar.size(), entry.value.scalar) == 0) {
    edits_.push_back({*begin, *begin + entry.value.scalar.size(), value});
    return true;
  }
  const std::optional<std::size_t> key = offset(entry.place);
  if (!key) return false;
  // A block: the key's line and those below that are indented deeper.
  const std::size_t end = block_end(*key, static_cast<std::size_t>(entry.place.column) - 1);
  edits_.push_back({*key, end, entry.key + ": " + value});
  return true;
}

bool TextEditor::add_key(const yaml::Node& map, const yaml::Node& after, const std::string& key,
                         const std::string& value) {
  const std::optional<std::size_t> begin = offset(map.place);
  const std::optional<std::size_t> other = offset(after.place);
  if (!begin || !other || map.entries.empty()) return false;
  if (text_[*begin] == '{') {
    edits_.push_back({*begin + 1, *begin + 1, key + ": " + value + ", "});
    return true;
  }
  const auto indent = static_cast<std::size_t>(map.entries.front().place.column) - 1;
  const std::size_t end = line_end(*other);
  edits_.push_back({end, end, "\n" + std::string(indent, ' ') + key + ": " + value});
  return true;
}

bool TextEditor::add_first_item(const yaml::Node& sequence, const std::string& item) {
  if (sequence.items.empty()) return false;
  const std::optional<std::size_t> first = offset(sequence.items.front().place);
  const std::optional<std::size_t> dash = dash_of(sequence.items.front());
  if (!first || !dash) return false;
  const std::size_t line = text_.rfind('\n', *first) + 1;
  edits_.push_back({line, line, std::string(*dash, ' ') + "- " + item + "\n"});
  return true;
}

bool TextEditor::add_last_items(const yaml::Node& sequence, const std::vector<std::string>& items) {
  if (items.empty()) return true;
  const std::optional<std::size_t> last = sequence.items.empty() ? std::nullopt : offset(sequence.items.back().place);
  if (!last) return false;
  std::string text;
  if (const std::optional<std::size_t> dash = dash_of(sequence.items.back())) {
    const std::size_t end = block_end(*last, *dash);
    for (const std::string& item : items) text += std::string(*dash, ' ') + "- " + item + "\n";
    if (end == text_.size())
      edits_.push_back({end, end, "\n" + text});
    else
      edits_.push_back({end + 1, end + 1, text});
    return true;
  }
  if (text_[*last] != '{') return false;
  for (const std::string& item : items) text += ", " + item;
  const std::size_t end = after_braces(*last);
  edits_.push_back({end, end, text});
  return true;
}

bool TextEditor::remove_item(const yaml::Node& sequence, std::size_t item) {
  const std::optional<std::size_t> begin = offset(sequence.items[item].place);
  const std::optional<std::size_t> dash = dash_of(sequence.items[item]);
  if (!begin || !dash) return false;
  const std::size_t line = text_.rfind('\n', *begin) + 1;
  const std::size_t end = std::min(block_end(*begin, *dash) + 1, text_.size());
  edits_.push_back({line, end, ""});
  return true;
}

bool TextEditor::remove_items(const yaml::Entry& entry) {
  const std::optional<std::size_t> key = offset(entry.place);
  if (!key) return false;
  for (std::size_t item = 0; item < entry.value.items.size(); ++item)
    if (!remove_item(entry.value, item)) return false;
  const std::size_t colon = text_.find(':', *key);
  if (colon == std::string::npos) return false;
  edits_.push_back({colon + 1, colon + 1, " []"});
  return true;
}

void TextEditor::append(const std::string& lines) {
  const bool open = !text_.empty() && text_.back() != '\n';
  edits_.push_back({text_.size(), text_.size(), (open ? "\n" : "") + lines});
}

std::string TextEditor::finish() {
  std::stable_sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.begin > b.begin; });
  for (const Edit& edit : edits_) text_.replace(edit.begin, edit.end - edit.begin, edit.text);
  return text_;
}

std::optional<std::size_t> TextEditor::offset(const Place& place) const {
  if (place.line < 1 || static_cast<std::size_t>(place.line) > starts_.size()) return std::nullopt;
  const std::size_t at = starts_[static_cast<std::size_t>(place.line) - 1] + static_cast<std::size_t>(place.column) - 1;
  return at < text_.size() ? std::optional(at) : std::nullopt;
}

std::size_t TextEditor::block_end(std::size_t at, std::size_t indent) const {
  std::size_t end = line_end(at), next = end;
  while (next < text_.size()) {
    const std::size_t first_of_line = next + 1;
    const std::size_t first = text_.find_first_not_of(' ', first_of_line);
    if (first == std::string::npos) break;
    const bool nothing = text_[first] == '\n' || text_[first] == '#';
    if (!nothing && first - first_of_line <= indent) break;
    next = line_end(first_of_line);
    if (!nothing) end = next;
  }
  return end;
}

std::optional<std::size_t> TextEditor::dash_of(const yaml::Node& item) const {
  const std::optional<std::size_t> at = offset(item.place);
  if (!at) return std::nullopt;
  const std::size_t line = *at == 0 ? 0 : text_.rfind('\n', *at - 1) + 1;
  const std::size_t dash = text_.find_first_not_of(' ', line);
  if (dash == std::string::npos || dash >= *at || text_[dash] != '-' || text_.find_first_not_of(' ', dash + 1) != *at)
    return std::nullopt;
  return dash - line;
}

std::size_t TextEditor::line_end(std::size_t at) const { return std::min(text_.find('\n', at), text_.size()); }

std::size_t TextEditor::after_quoted(std::size_t at) const {
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

std::size_t TextEditor::after_braces(std::size_t at) const {
  int depth = 0;
  while (at < text_.size()) {
    const char c = text_[at];
    if (c == '"' || c == '\'') {
      at = after_quoted(at);
      continue;
    }
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && --depth == 0) return at + 1;
    ++at;
  }
  return text_.size();
}

}  // namespace sparsha::scene
