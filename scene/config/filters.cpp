// Reads the block `filters`, one function a filter.
#include <array>
#include <cmath>
#include <utility>

#include "base/text/lower_case.h"
#include "scene/config/reader.h"

namespace sparsha::scene {
namespace {

using yaml::MapReader;
using yaml::Node;

template <typename Method>
void read_method(MapReader& keys, Method& method) {
  int choice = 0;
  keys.read_choice("method", choice, {"fast", "pcl"});
  method = static_cast<Method>(choice);
}

CropConfig parse_crop(const Node& node) {
  MapReader keys(node, "crop");
  CropConfig config{vector(keys.required("min_m")), vector(keys.required("max_m"))};
  keys.finish();
  if (!(config.min_m.array() < config.max_m.array()).all()) {
    throw yaml::error_at(node, "the crop box is empty", "min_m below max_m in x, y and z");
  }
  return config;
}

VoxelConfig parse_voxel(const Node& node) {
  MapReader keys(node, "voxel");
  VoxelConfig config;
  read_mm(keys, "leaf_mm", config.leaf_m, kSmallest, kAny);
  keys.finish();
  return config;
}

OutlierConfig parse_outliers(const Node& node) {
  OutlierConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader keys(node, "outliers");
  keys.read("neighbours", config.neighbours, 1, 1000);
  keys.read("sigma", config.sigma, 1e-6, 1e6);
  read_method(keys, config.method);
  keys.finish();
  return config;
}

RadiusOutlierConfig parse_radius_outliers(const Node& node) {
  RadiusOutlierConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader keys(node, "radius_outliers");
  read_mm(keys, "radius_mm", config.radius_m, kSmallest, kAny);
  keys.read("neighbours", config.neighbours, 1, 1000);
  read_method(keys, config.method);
  keys.finish();
  return config;
}

PassConfig parse_pass(const Node& node) {
  PassConfig config;
  MapReader keys(node, "pass");
  static_cast<void>(keys.required("axis"));
  keys.read_choice("axis", config.axis, {"x", "y", "z"});
  const bool low = keys.optional("min_m") != nullptr;
  const bool high = keys.optional("max_m") != nullptr;
  if (low) keys.read("min_m", config.min_m, -kAny, kAny);
  if (high) keys.read("max_m", config.max_m, -kAny, kAny);
  keys.finish();
  if (!low && !high) throw yaml::error_at(node, "pass has no limit", "min_m, max_m or both");
  if (!(config.min_m < config.max_m)) throw yaml::error_at(node, "pass keeps nothing", "min_m below max_m");
  return config;
}

RemovePlaneConfig parse_remove_plane(const Node& node) {
  RemovePlaneConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader keys(node, "remove_plane");
  read_mm(keys, "distance_mm", config.distance_m, kSmallest, kAny);
  int side = 0;
  keys.read_choice("side", side, {"below", "above", "both"});
  config.side = static_cast<RemovePlaneConfig::Side>(side);
  if (const Node* normal = keys.optional("normal")) {
    config.normal = vector(*normal);
    const double length = config.normal.norm();
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw yaml::error_at(*normal, "normal has no direction", "a vector that is not 0 0 0");
    }
  }
  // 0 would be no limit at all in PCL, and no measured plane has exactly the direction of a vector.
  keys.read("max_angle_deg", config.max_angle_deg, 0.01, 90.0);
  keys.finish();
  return config;
}

KeepConfig parse_keep(const Node& node) {
  KeepConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader keys(node, "keep");
  const int form = exclusive(keys, {"cluster", "nearest_to"});
  if (form == 1) config.nearest_to_m = vector(keys.required("nearest_to"));
  if (form == 0) {
    const Node& cluster = keys.required("cluster");
    if (cluster.is_map()) {
      MapReader place(cluster, "cluster");
      config.nearest_to_m = vector(place.required("nearest_to"));
      place.finish();
    } else if (yaml::to_text(cluster) != "largest") {
      throw yaml::error_at(cluster, "cluster is '" + cluster.scalar + "'", "largest, or nearest_to: [x, y, z]");
    }
  }
  read_mm(keys, "tolerance_mm", config.tolerance_m, kSmallest, kAny);
  read_method(keys, config.method);
  keys.finish();
  return config;
}

SmoothConfig parse_smooth(const Node& node) {
  SmoothConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader keys(node, "smooth");
  read_mm(keys, "radius_mm", config.radius_m, kSmallest, kAny);
  keys.read("order", config.order, 1, 4);
  read_method(keys, config.method);
  keys.finish();
  return config;
}

ThinConfig parse_thin(const Node& node) {
  ThinConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader keys(node, "thin");
  keys.read("points_per_node", config.points_per_node, 1, 1000000);
  keys.finish();
  return config;
}

FieldConfig parse_field(const Node& node) {
  FieldConfig config;
  MapReader keys(node, "field");
  config.name = yaml::to_text(keys.required("name"));
  const bool low = keys.optional("min") != nullptr;
  const bool high = keys.optional("max") != nullptr;
  if (low) keys.read("min", config.min, -kAny, kAny);
  if (high) keys.read("max", config.max, -kAny, kAny);
  keys.finish();
  if (config.name.empty()) throw yaml::error_at(node, "field has no name", "a name that `sparsha info` lists");
  if (!low && !high) throw yaml::error_at(node, "field has no limit", "min, max or both");
  if (!(config.min <= config.max)) throw yaml::error_at(node, "field keeps nothing", "min up to max");
  return config;
}

ClassesConfig parse_classes(const Node& node) {
  ClassesConfig config;
  MapReader keys(node, "classes");
  const int form = exclusive(keys, {"keep", "drop"});
  if (form < 0) throw yaml::error_at(node, "classes names none", "keep: [2, 6] or drop: [7, 18]");
  const Node& list = keys.required(form == 0 ? "keep" : "drop");
  if (!list.is_sequence() || list.items.empty()) {
    throw yaml::error_at(list, "the list of classes is empty", "one class or more, 0 to 255");
  }
  for (const Node& item : list.items) {
    const std::int64_t value = yaml::to_integer(item);
    if (value < 0 || value > 255) throw yaml::error_at(item, "no class has this number", "0 to 255");
    (form == 0 ? config.keep : config.drop).push_back(static_cast<int>(value));
  }
  keys.finish();
  return config;
}

using Parser = FilterConfig (*)(const Node&);
template <auto kParse>
FilterConfig parse_with(const Node& node) {
  return kParse(node);
}

/// In the order of FilterConfig's alternatives.
const std::array<std::pair<const char*, Parser>, std::variant_size_v<FilterConfig::variant>> kFilters{{
    {"crop", parse_with<parse_crop>},
    {"voxel", parse_with<parse_voxel>},
    {"outliers", parse_with<parse_outliers>},
    {"radius_outliers", parse_with<parse_radius_outliers>},
    {"pass", parse_with<parse_pass>},
    {"remove_plane", parse_with<parse_remove_plane>},
    {"keep", parse_with<parse_keep>},
    {"smooth", parse_with<parse_smooth>},
    {"thin", parse_with<parse_thin>},
    {"field", parse_with<parse_field>},
    {"classes", parse_with<parse_classes>},
}};

std::string filter_names() {
  std::string names = "one of ";
  for (const auto& [name, parser] : kFilters) names += std::string(names.size() > 7 ? ", " : "") + name;
  return names;
}

FilterConfig parse_filter(const Node& node) {
  MapReader reader(node, "a filter");
  const Parser* parser = nullptr;
  const Node* value = nullptr;
  for (const auto& [name, parse] : kFilters) {
    if (const Node* found = reader.optional(name)) {
      parser = &parse;
      value = found;
    }
  }
  reader.finish();
  if (node.entries.empty()) throw yaml::error_at(node, "an empty filter", filter_names());
  if (node.entries.size() != 1) {
    throw yaml::error_at(node, "a filter has " + std::to_string(node.entries.size()) + " keys", filter_names());
  }
  FilterConfig filter = (*parser)(*value);
  filter.place = node.entries.front().place;
  return filter;
}

}  // namespace

std::string filter_name(const FilterConfig& filter) { return kFilters[filter.index()].first; }

std::vector<FilterConfig> parse_filters(const Node& node) {
  if (!node.is_sequence()) throw yaml::error_at(node, "filters is not a list", "a list of filters");
  std::vector<FilterConfig> filters;
  bool smoothed = false;
  bool merged = false;
  for (const Node& item : node.items) {
    filters.push_back(parse_filter(item));
    if (std::holds_alternative<SmoothConfig>(filters.back())) smoothed = true;
    if (smoothed && std::holds_alternative<VoxelConfig>(filters.back())) {
      throw yaml::error_at(item, "'voxel' after 'smooth' mixes moved points with others",
                           "'voxel' before 'smooth', or 'thin' after it");
    }
    const auto* field = std::get_if<FieldConfig>(&filters.back());
    const bool by_value = std::holds_alternative<ClassesConfig>(filters.back()) ||
                          (field != nullptr && lower_case(field->name) != "intensity");
    if (merged && by_value) {
      throw yaml::error_at(item, "'" + filter_name(filters.back()) + "' after 'voxel', whose means have no such value",
                           "'" + filter_name(filters.back()) + "' before 'voxel'");
    }
    if (std::holds_alternative<VoxelConfig>(filters.back())) merged = true;
  }
  return filters;
}

}  // namespace sparsha::scene
