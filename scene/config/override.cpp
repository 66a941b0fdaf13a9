// A key that is set takes the place of those that would contradict it, as grid.size does of grid.spacing_mm.
#include "scene/config/override.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sparsha::scene {
namespace {

struct Rivals {
  std::string_view block;
  std::vector<std::string_view> keys;  ///< any of these ...
  std::vector<std::string_view> gone;  ///< ... stands against any of these but itself
};

const std::vector<Rivals>& rivals() {
  static const std::vector<Rivals> all = {
      {"grid", {"size", "spacing_mm"}, {"size", "spacing_mm"}},
      {"orientation", {"euler_deg", "quaternion"}, {"look_from", "up", "euler_deg", "quaternion", "matrix", "face"}},
      {"orientation", {"matrix"}, {"look_from", "up", "euler_deg", "quaternion", "scale", "face"}},
      {"orientation", {"look_from"}, {"euler_deg", "quaternion", "matrix", "face"}},
      {"orientation", {"face"}, {"look_from", "euler_deg", "quaternion", "matrix"}},
      {"orientation", {"up"}, {"euler_deg", "quaternion", "matrix"}},
      {"pose", {"euler_deg", "quaternion"}, {"euler_deg", "quaternion", "matrix"}},
      {"pose", {"matrix"}, {"euler_deg", "quaternion", "translate"}},
  };
  return all;
}

std::string_view path_of(std::string_view setting) { return setting.substr(0, setting.find('=')); }

/// "scans[0].units=mm" as "scans.0.units=mm". Throws Error{usage} for a place in a list without its number.
std::string with_dots(const std::string& setting) {
  const std::string_view path = path_of(setting);
  std::string dotted;
  for (std::size_t at = 0; at < path.size(); ++at) {
    if (path[at] != '[') {
      dotted += path[at];
      continue;
    }
    const std::size_t end = path.find(']', at);
    if (end == std::string_view::npos || end == at + 1)
      throw usage_error("--set " + setting + " does not say which place of the list",
                        "a number from 0, e.g. scans[0].units=mm");
    dotted += "." + std::string(path.substr(at + 1, end - at - 1));
    at = end;
  }
  return dotted + setting.substr(path.size());
}

yaml::Node* block_at(yaml::Node& root, std::string_view path) {
  yaml::Node* node = &root;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    const std::string_view key = path.substr(0, dot);
    path = dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1);
    if (node->is_sequence()) {
      node = &node->items[static_cast<std::size_t>(std::stoul(std::string(key)))];  // yaml::set has checked it
      continue;
    }
    const auto entry =
        std::find_if(node->entries.begin(), node->entries.end(), [&](const yaml::Entry& e) { return e.key == key; });
    if (entry == node->entries.end()) return nullptr;
    node = &entry->value;
  }
  return node;
}

}  // namespace

void override_keys(yaml::Node& root, const std::vector<std::string>& given) {
  std::vector<std::string> settings;
  for (const std::string& setting : given) settings.push_back(with_dots(setting));
  for (const std::string& setting : settings) yaml::set(root, setting);
  const auto is_set = [&](const std::string& path) {
    return std::any_of(settings.begin(), settings.end(), [&](const std::string& s) { return path_of(s) == path; });
  };
  for (const std::string& setting : settings) {
    const std::string_view path = path_of(setting);
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos) continue;
    const std::string_view parent = path.substr(0, dot);
    const std::string_view key = path.substr(dot + 1);
    const std::string_view block = parent.substr(parent.rfind('.') + 1);
    for (const Rivals& rival : rivals()) {
      if (rival.block != block || std::find(rival.keys.begin(), rival.keys.end(), key) == rival.keys.end()) continue;
      yaml::Node* const node = block_at(root, parent);
      if (node == nullptr) continue;
      std::erase_if(node->entries, [&](const yaml::Entry& entry) {
        return entry.key != key && std::find(rival.gone.begin(), rival.gone.end(), entry.key) != rival.gone.end() &&
               !is_set(std::string(parent) + "." + entry.key);
      });
    }
  }
}

}  // namespace sparsha::scene
