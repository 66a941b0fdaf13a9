// Edits by the places of the YAML reader; the result is read again and compared before it is used.
#include "scene/config/setup_text.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "scene/config/text_editor.h"
#include "scene/frame/euler.h"

namespace sparsha::scene {
namespace {

namespace fs = std::filesystem;

std::string numbers_text(const Eigen::Vector3d& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string matrix_text(const Eigen::Matrix4d& m) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) text += fmt::format("{}{}", text.size() > 1 ? ", " : "", m(row, column));
  return text + "]";
}

// As people write it: angles, where there is only a rotation and a scale.
std::string orientation_text(const OrientationConfig& orientation) {
  const Eigen::Matrix4d& m = orientation.scan_to_grid;
  const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>();
  const double scale = std::cbrt(std::max(linear.determinant(), 0.0));
  constexpr double kRounding = 1e-12;
  const bool similar = scale > 0.0 && m.topRightCorner<3, 1>().isZero(0.0) &&
                       (linear.transpose() * linear / (scale * scale)).isIdentity(kRounding);
  std::string text = "{matrix: " + matrix_text(m);
  if (similar) {
    text = "{euler_deg: " + numbers_text(euler_deg(linear / scale));
    if (std::abs(scale - 1.0) > kRounding) text += fmt::format(", scale: {}", scale);
  }
  if (orientation.regions_scan_to_grid) text += ", regions_matrix: " + matrix_text(*orientation.regions_scan_to_grid);
  return text + "}";
}

std::string units_text(const Units& units) {
  if (units.unit == LengthUnit::longest_side)
    return fmt::format("{{longest_side_mm: {}}}", units.longest_side_m * 1000.0);
  return to_string(units.unit);
}

const yaml::Entry* entry_of(const yaml::Node& map, std::string_view key) {
  const auto found = std::ranges::find_if(map.entries, [&](const yaml::Entry& entry) { return entry.key == key; });
  return found == map.entries.end() ? nullptr : &*found;
}

const CropConfig* crop_of(const Config& config) {
  for (const FilterConfig& filter : config.filters)
    if (const auto* crop = std::get_if<CropConfig>(&filter)) return crop;
  return nullptr;
}

bool set_units(TextEditor& editor, const yaml::Node& root, const Config& given, const Config& wanted) {
  const yaml::Node* scans = root.find("scans");
  if (scans == nullptr || scans->items.size() != wanted.scans.size()) return false;
  for (std::size_t s = 0; s < wanted.scans.size(); ++s) {
    const Units& units = wanted.scans[s].units;
    const Units& old = given.scans[s].units;
    if (units.unit == old.unit && units.longest_side_m == old.longest_side_m) continue;
    const yaml::Node& scan = scans->items[s];
    const yaml::Entry* entry = entry_of(scan, "units");
    const bool set = entry != nullptr ? editor.set_value(*entry, units_text(units))
                                      : editor.add_key(scan, *scan.find("file"), "units", units_text(units));
    if (!set) return false;
  }
  return true;
}

bool remove_crop(TextEditor& editor, const yaml::Entry& filters) {
  if (filters.value.items.size() == 1) return editor.remove_items(filters);
  for (std::size_t item = 0; item < filters.value.items.size(); ++item)
    if (entry_of(filters.value.items[item], "crop") != nullptr) return editor.remove_item(filters.value, item);
  return false;
}

bool set_crop(TextEditor& editor, const yaml::Node& root, const Config& given, const Config& wanted) {
  const CropConfig* crop = crop_of(wanted);
  const CropConfig* old = crop_of(given);
  const yaml::Node* filters = root.find("filters");
  if (crop == nullptr) return old == nullptr || remove_crop(editor, *entry_of(root, "filters"));
  if (old != nullptr && crop->min_m == old->min_m && crop->max_m == old->max_m) return true;
  const std::string value =
      fmt::format("{{min_m: {}, max_m: {}}}", numbers_text(crop->min_m), numbers_text(crop->max_m));
  if (filters == nullptr) {
    editor.append("filters:\n  - crop: " + value + "\n");
    return true;
  }
  if (filters->items.empty()) return editor.set_value(*entry_of(root, "filters"), "[{crop: " + value + "}]");
  if (old == nullptr) return editor.add_first_item(*filters, "crop: " + value);
  for (const yaml::Node& item : filters->items)
    if (const yaml::Entry* entry = entry_of(item, "crop")) return editor.set_value(*entry, value);
  return false;
}

/// The same part, wherever its box is.
bool is_same_part(const PartConfig& given, const PartConfig& wanted) {
  PartConfig moved = wanted;
  moved.box_m = given.box_m;
  return part_text(moved) == part_text(given);
}

// As parts are edited on the object: moved, removed, drawn anew behind the others.
bool set_parts(TextEditor& editor, const yaml::Node& root, const Config& given, const Config& wanted) {
  const yaml::Entry* entry = entry_of(root, "parts");
  std::string all;
  for (const PartConfig& part : wanted.parts) all += "  - " + part_text(part) + "\n";
  if (entry == nullptr) {
    if (!wanted.parts.empty()) editor.append("parts:\n" + all);
    return true;
  }
  const yaml::Node& list = entry->value;
  if (list.items.size() != given.parts.size()) return false;
  std::vector<std::size_t> gone;
  std::size_t next = 0;
  for (std::size_t item = 0; item < given.parts.size(); ++item) {
    const PartConfig& old = given.parts[item];
    if (next >= wanted.parts.size() || !is_same_part(old, wanted.parts[next])) {
      gone.push_back(item);
      continue;
    }
    const PartConfig& part = wanted.parts[next++];
    if (part.box_m == old.box_m) continue;
    const yaml::Entry* box = entry_of(list.items[item], "box_m");
    if (box == nullptr || !editor.set_value(*box, box_text(part.box_m))) return false;
  }
  if (list.items.empty()) return wanted.parts.empty() || editor.set_value(*entry, "\n" + all);
  if (wanted.parts.empty()) return editor.remove_items(*entry);
  for (const std::size_t item : gone)
    if (!editor.remove_item(list, item)) return false;
  std::vector<std::string> more;
  for (; next < wanted.parts.size(); ++next) more.push_back(part_text(wanted.parts[next]));
  return editor.add_last_items(list, more);
}

std::optional<std::string> edited(const std::string& text, const Config& wanted, const fs::path& folder) {
  if (text.empty()) return std::nullopt;
  const yaml::Node root = yaml::parse_text(text, "the configuration");
  if (describes_scene(root)) return std::nullopt;
  const Config given = parse_config(root, folder);
  TextEditor editor(text);
  const yaml::Entry* orientation = entry_of(root, "orientation");
  const std::string value = orientation_text(wanted.orientation);
  if (orientation == nullptr) {
    editor.append("orientation: " + value + "\n");
  } else if (!editor.set_value(*orientation, value)) {
    return std::nullopt;
  }
  if (!set_units(editor, root, given, wanted) || !set_crop(editor, root, given, wanted) ||
      !set_parts(editor, root, given, wanted))
    return std::nullopt;
  return editor.finish();
}

bool says(const std::string& text, const Config& wanted, const fs::path& folder) {
  constexpr double kRounding = 1e-12;
  Config read = parse_config(yaml::parse_text(text, "the edited configuration"), folder);
  Eigen::Matrix4d& m = read.orientation.scan_to_grid;
  const Eigen::Matrix4d& target = wanted.orientation.scan_to_grid;
  if ((m - target).cwiseAbs().maxCoeff() > kRounding * std::max(1.0, target.cwiseAbs().maxCoeff())) return false;
  m = target;
  return comparable_text(read) == comparable_text(wanted);
}

}  // namespace

SetupText text_with_setup(const std::string& text, const Config& wanted, const fs::path& folder) {
  try {
    if (const auto result = edited(text, wanted, folder); result && says(*result, wanted, folder))
      return {*result, true};
  } catch (const Error&) {
    // The text is not a configuration any more: what is wanted is written anew.
  }
  Config moved = wanted;
  relocate(moved, folder);
  return {to_yaml(moved), false};
}

void scale_parts(Config& config, double factor) {
  for (PartConfig& part : config.parts) {
    for (double& side_m : part.box_m) side_m *= factor;
    if (part.solid_m)
      for (double& side_m : *part.solid_m) side_m *= factor;
    for (auto& corner_m : part.polygon_m)
      for (double& coordinate_m : corner_m) coordinate_m *= factor;
  }
}

void scale_lengths(Config& config, double factor) {
  scale_parts(config, factor);
  config.grid.spacing_m *= factor;
  if (config.grid.noise_m) *config.grid.noise_m *= factor;
  if (config.fill) config.fill->max_gap_m *= factor;
  if (config.texture) {
    config.texture->sigma_space_m *= factor;
    config.texture->sigma_range_m *= factor;
  }
  if (config.friction) config.friction->scale_m *= factor;
  for (FilterConfig& filter : config.filters) {
    if (auto* crop = std::get_if<CropConfig>(&filter)) {
      crop->min_m *= factor;
      crop->max_m *= factor;
    }
  }
}

}  // namespace sparsha::scene
