// Lengths, places, vectors and keys that exclude each other.
#include "scene/config/reader.h"

#include <cmath>

#include "base/files/paths.h"
#include "scene/area/polygon.h"

namespace sparsha::scene {

void read_mm(yaml::MapReader& reader, std::string_view key, double& value_m, double low_mm, double high_mm) {
  constexpr double kMm = 1e-3;
  if (reader.optional(key) == nullptr) return;
  double value_mm = 0.0;
  reader.read(key, value_mm, low_mm, high_mm);
  value_m = value_mm * kMm;
}

void read_material(yaml::MapReader& reader, std::string_view key, Material& material) {
  std::vector<std::string> names;
  for (const MaterialTouch& known : kMaterials) names.emplace_back(known.name);
  int index = static_cast<int>(material);
  reader.read_choice(key, index, names);
  material = static_cast<Material>(index);
}

void read_number(yaml::MapReader& reader, std::string_view key, std::optional<double>& value, double low, double high) {
  if (reader.optional(key) == nullptr) return;
  double number = low;
  reader.read(key, number, low, high);
  value = number;
}

std::array<double, 4> read_box(const yaml::Node& node) {
  const std::vector<double> v = yaml::to_doubles(node, 4);
  if (!(v[0] < v[2] && v[1] < v[3])) {
    throw yaml::error_at(node, "the box is empty", "[xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax");
  }
  return {v[0], v[1], v[2], v[3]};
}

std::optional<std::array<double, 6>> read_solid_box(const yaml::Node& node) {
  if (!node.is_sequence() || node.items.size() != 6) return std::nullopt;
  const std::vector<double> v = yaml::to_doubles(node, 6);
  if (!(v[0] < v[3] && v[1] < v[4] && v[2] < v[5])) {
    throw yaml::error_at(node, "the box is empty",
                         "[xmin, ymin, zmin, xmax, ymax, zmax] with each minimum below its maximum");
  }
  return std::array<double, 6>{v[0], v[1], v[2], v[3], v[4], v[5]};
}

std::vector<std::array<double, 2>> read_polygon(const yaml::Node& node) {
  std::vector<std::array<double, 2>> corners;
  if (!node.is_sequence() || node.items.size() < 3) {
    throw yaml::error_at(node, "the polygon has fewer than three corners", "[[x, y], [x, y], [x, y], ...]");
  }
  if (node.items.size() > Polygon::kMostCorners) {
    throw yaml::error_at(node, "the polygon has " + std::to_string(node.items.size()) + " corners",
                         "at most " + std::to_string(Polygon::kMostCorners));
  }
  for (const yaml::Node& item : node.items) {
    const std::vector<double> corner = yaml::to_doubles(item, 2);
    if (!(std::abs(corner[0]) <= kAny && std::abs(corner[1]) <= kAny)) {
      throw yaml::error_at(item, "the corner is farther away than 1e12 m", "metres in the grid frame");
    }
    corners.push_back({corner[0], corner[1]});
  }
  // A line that crosses itself may enclose as much to its left as to its right.
  if (!(std::abs(signed_area_m2(corners)) > 0.0) && !Polygon(corners).deepest_m()) {
    throw yaml::error_at(node, "the polygon has no area", "corners in their order");
  }
  return corners;
}

int read_label(const yaml::Node& node) {
  const std::int64_t value = yaml::to_integer(node);
  if (value < 1 || value > 65535) throw yaml::error_at(node, "label is " + node.scalar, "1 to 65535");
  return static_cast<int>(value);
}

std::filesystem::path resolved(const yaml::Node& node, const std::filesystem::path& folder) {
  const std::filesystem::path path = yaml::to_text(node);
  if (path.empty()) throw yaml::error_at(node, "the file name is empty", "a path relative to this file");
  return path.is_absolute() || folder.empty() ? path : without_dots(folder / path);
}

Eigen::Vector3d vector(const yaml::Node& node) {
  const std::vector<double> v = yaml::to_doubles(node, 3);
  return {v[0], v[1], v[2]};
}

int exclusive(yaml::MapReader& reader, const std::vector<std::string>& keys) {
  int found = -1;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const yaml::Node* value = reader.optional(keys[i]);
    if (value == nullptr) continue;
    if (found >= 0) {
      throw yaml::error_at(*value, "'" + keys[static_cast<std::size_t>(found)] + "' and '" + keys[i] + "' contradict",
                           "one of them");
    }
    found = static_cast<int>(i);
  }
  return found;
}

}  // namespace sparsha::scene
