#include "app/keys/reference.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml.h"
#include "scene/keys/keys.h"

namespace sparsha::app {
namespace {

using scene::Form;
using scene::Key;
using Kind = Form::Kind;

std::string joined(const std::vector<std::string>& parts, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : i + 1 == parts.size() ? last : ", ") + parts[i];
  return text;
}

std::string words(const Form& form) { return joined({form.words.begin(), form.words.end()}, " or "); }

/// "from 2 to 1048576"; limits that are there to catch slips are not told.
std::string range(const Form& form, const char* what) {
  const bool any_most = form.most >= scene::kNoMost;
  if (any_most && form.least == -scene::kNoMost) return what;
  if (any_most && form.least == scene::kNoLeast) return fmt::format("{} above 0", what);
  if (any_most) return fmt::format("{} of {} or more", what, exact_text(form.least));
  return fmt::format("{} from {} to {}", what, exact_text(form.least), exact_text(form.most));
}

std::string form_text(const Form& form) {
  switch (form.kind) {
    case Kind::nothing:
      return "nothing";
    case Kind::block:
      return "block";
    case Kind::list:
      return "list of blocks";
    case Kind::number:
      return range(form, "number");
    case Kind::whole:
      return range(form, "whole number");
    case Kind::toggle:
      return "on or off";
    case Kind::text:
      return "text";
    case Kind::file:
      return "file";
    case Kind::word:
      return words(form);
    case Kind::words:
      return "list of " + words(form);
    case Kind::wholes:
      return "list of whole numbers from " + exact_text(form.least) + " to " + exact_text(form.most);
    case Kind::numbers:
      return exact_text(form.least) + " numbers";
    case Kind::matrix:
      return "16 numbers, row by row";
    case Kind::points:
      return fmt::format("{} to {} points [x, y]", exact_text(form.least), exact_text(form.most));
    case Kind::places:
      return fmt::format("{} to {} points [x, y, z]", exact_text(form.least), exact_text(form.most));
  }
  return {};
}

std::string value_text_of(const Key& key) {
  std::vector<std::string> forms;
  for (const Form& form : key.forms) forms.push_back(form_text(form));
  return joined(forms, "; or ") + (key.unit.empty() ? "" : " (" + std::string(key.unit) + ")");
}

std::string absent_text(const Key& key) {
  if (key.absent == "true") return "on";
  return key.absent == "false" ? "off" : std::string(key.absent);
}

bool is_of(const Key& key, std::string_view block) {
  if (block.empty() || key.path == block) return true;
  return key.path.starts_with(block) && (key.path[block.size()] == '.' || key.path[block.size()] == '[');
}

std::vector<const Key*> chosen(std::string_view block) {
  std::vector<const Key*> keys;
  std::vector<std::string> names;
  for (const Key& key : scene::config_keys()) {
    if (is_of(key, block)) keys.push_back(&key);
    names.emplace_back(key.path);
  }
  if (!keys.empty()) return keys;
  const std::string near = yaml::nearest(block, names);
  throw usage_error(fmt::format("the configuration has no key '{}'", block),
                    near.empty() ? "a block, such as grid or audio.regions" : "did you mean '" + near + "'?");
}

}  // namespace

std::string reference_text(std::string_view block) {
  std::string text;
  for (const Key* key : chosen(block)) {
    text += fmt::format("{}: {}. {}.", key->path, value_text_of(*key), key->sentence);
    if (!key->absent.empty()) text += " Default " + absent_text(*key) + ".";
    if (key->required) text += " Required.";
    text += "\n";
  }
  return text;
}

std::string reference_json(std::string_view block) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Key* key : chosen(block)) {
    list.push_back({{"key", key->path},
                    {"value", value_text_of(*key)},
                    {"unit", key->unit},
                    {"default", absent_text(*key)},
                    {"required", key->required},
                    {"text", key->sentence}});
  }
  return list.dump(2) + "\n";
}

}  // namespace sparsha::app
