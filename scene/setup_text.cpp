// Edits by the places of the YAML reader; the result is read again and compared before it is used.
#include "scene/setup_text.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "base/error.h"
#include "base/yaml.h"
#include "scene/euler.h"
#include "scene/text_editor.h"

namespace sparsha::pipeline {
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

bool set_crop(TextEditor& editor, const yaml::Node& root, const Config& given, const Config& wanted) {
  const CropConfig* crop = crop_of(wanted);
  const CropConfig* old = crop_of(given);
  if (crop == nullptr) return old == nullptr;  // an item is not taken out of a text
  if (old != nullptr && crop->min_m == old->min_m && crop->max_m == old->max_m) return true;
  const std::string value =
      fmt::format("{{min_m: {}, max_m: {}}}", numbers_text(crop->min_m), numbers_text(crop->max_m));
  const yaml::Node* filters = root.find("filters");
  if (filters == nullptr || !filters->is_sequence() || filters->items.empty()) {
    if (filters != nullptr) return false;
    editor.append("filters:\n  - crop: " + value + "\n");
    return true;
  }
  if (old == nullptr) return editor.add_first_item(*filters, "crop: " + value);
  for (const yaml::Node& item : filters->items)
    if (const yaml::Entry* entry = entry_of(item, "crop")) return editor.set_value(*entry, value);
  return false;
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
  if (!set_units(editor, root, given, wanted) || !set_crop(editor, root, given, wanted)) return std::nullopt;
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

void scale_lengths(Config& config, double factor) {
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

}  // namespace sparsha::pipeline
