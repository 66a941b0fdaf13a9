// Reads every block of the configuration and refuses what it does not know.
#include "scene/config/block_hint.h"
#include "scene/config/override.h"
#include "scene/config/reader.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/ranges.h>

#include "base/phrases.h"
#include "scene/config/config.h"

namespace sparsha::scene {
namespace {

using yaml::MapReader;
using yaml::Node;

constexpr std::array<std::string_view, 3> kSceneKeys = {"scene", "origin_m", "scan_from_grid"};
constexpr double kLeastStiffness_n_per_m = 1.0;
constexpr double kMostStiffness_n_per_m = 1e5;
constexpr double kMostFriction = 10.0;

// Rotation about fixed axes, x first.
Eigen::Matrix3d euler(const Node& node) {
  const Eigen::Vector3d radians = vector(node) * (std::numbers::pi / 180.0);
  return (Eigen::AngleAxisd(radians.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(radians.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(radians.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Matrix3d quaternion(const Node& node) {
  const std::vector<double> v = yaml::to_doubles(node, 4);
  const Eigen::Quaterniond q(v[3], v[0], v[1], v[2]);
  if (std::abs(q.norm() - 1.0) > 1e-2) {
    throw yaml::error_at(node, "the quaternion does not have length 1", "[x, y, z, w] of length 1");
  }
  return q.normalized().toRotationMatrix();
}

Eigen::Matrix4d matrix(const Node& node) {
  std::vector<double> v;
  if (node.is_sequence() && node.items.size() == 4 && node.items.front().is_sequence()) {
    for (const Node& row : node.items)
      for (const double value : yaml::to_doubles(row, 4)) v.push_back(value);
  } else {
    v = yaml::to_doubles(node, 16);
  }
  Eigen::Matrix4d m;
  for (int i = 0; i < 16; ++i) m(i / 4, i % 4) = v[static_cast<std::size_t>(i)];
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw yaml::error_at(node, "the last row is not 0 0 0 1", "an affine 4x4 matrix, row by row");
  }
  const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>();
  const double size = linear.cwiseAbs().maxCoeff();
  if (!(size > 0.0) || std::abs((linear / size).determinant()) < 1e-9) {
    throw yaml::error_at(node, "the matrix is singular", "an invertible affine matrix");
  }
  return m;
}

Units parse_units(const Node& node) {
  Units units;
  if (node.is_map()) {
    MapReader reader(node, "units");
    static_cast<void>(reader.required("longest_side_mm"));
    units.unit = LengthUnit::longest_side;
    read_mm(reader, "longest_side_mm", units.longest_side_m, kSmallest, kAny);
    reader.finish();
    return units;
  }
  const std::string text = yaml::to_text(node);
  std::vector<std::string> names;
  for (const LengthUnit unit : {LengthUnit::m, LengthUnit::cm, LengthUnit::mm, LengthUnit::ft, LengthUnit::us_ft}) {
    names.push_back(to_string(unit));
    units.unit = unit;
    if (text == names.back()) return units;
  }
  std::string expected = "m | cm | mm | ft | us_ft | {longest_side_mm: NUMBER}";
  if (const std::string near = yaml::nearest(text, names); !near.empty()) {
    expected += " (did you mean '" + near + "'?)";
  }
  throw yaml::error_at(node, "units is '" + text + "'", expected);
}

Eigen::Matrix4d parse_pose(const Node& node) {
  MapReader reader(node, "pose");
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  const int form = exclusive(reader, {"quaternion", "euler_deg", "matrix"});
  if (form == 0) pose.topLeftCorner<3, 3>() = quaternion(reader.required("quaternion"));
  if (form == 1) pose.topLeftCorner<3, 3>() = euler(reader.required("euler_deg"));
  if (form == 2) {
    const Node& value = reader.required("matrix");
    pose = matrix(value);
    const Eigen::Matrix3d r = pose.topLeftCorner<3, 3>();
    if (!(r * r.transpose()).isIdentity(1e-3) || r.determinant() < 0) {
      throw yaml::error_at(value, "the pose's matrix is not rigid",
                           "a rotation and a translation; sizes belong in units");
    }
  }
  if (const Node* translate = reader.optional("translate")) {
    if (form == 2) throw yaml::error_at(*translate, "'matrix' and 'translate' contradict", "one of them");
    pose.topRightCorner<3, 1>() = vector(*translate);
  }
  reader.finish();
  return pose;
}

/// Field names of a text file's columns; x, y and z once each, colours and normals with all three parts or none.
std::vector<std::string> parse_columns(const Node& node) {
  static const std::vector<std::string> kNames{"skip", "x",         "y",  "z",  "red", "green",
                                               "blue", "intensity", "nx", "ny", "nz"};
  if (!node.is_sequence()) throw yaml::error_at(node, "columns is not a list", "[skip, x, y, z, red, green, blue]");
  std::vector<std::string> columns;
  for (const Node& item : node.items) {
    columns.push_back(yaml::to_text(item));
    if (std::find(kNames.begin(), kNames.end(), columns.back()) == kNames.end()) {
      const std::string near = yaml::nearest(columns.back(), kNames);
      throw yaml::error_at(item, "a column is called '" + columns.back() + "'",
                           "skip | x | y | z | red | green | blue | intensity | nx | ny | nz" +
                               (near.empty() ? "" : " (did you mean '" + near + "'?)"));
    }
    if (columns.back() != "skip" && std::count(columns.begin(), columns.end(), columns.back()) > 1) {
      throw yaml::error_at(item, "two columns are called '" + columns.back() + "'", "each name once, but skip");
    }
  }
  for (const char* axis : {"x", "y", "z"}) {
    if (std::find(columns.begin(), columns.end(), axis) == columns.end()) {
      throw yaml::error_at(node, std::string("no column is called ") + axis, "x, y and z among the columns");
    }
  }
  const auto is_named = [&](const char* name) {
    return std::find(columns.begin(), columns.end(), name) != columns.end();
  };
  constexpr std::array<std::array<const char*, 3>, 2> kTriples{{{"red", "green", "blue"}, {"nx", "ny", "nz"}}};
  for (const auto& [a, b, c] : kTriples) {
    if ((is_named(a) || is_named(b) || is_named(c)) && !(is_named(a) && is_named(b) && is_named(c))) {
      throw yaml::error_at(node, fmt::format("not all of {}, {} and {} are among the columns", a, b, c),
                           "the three of them or none");
    }
  }
  return columns;
}

ScanConfig parse_scan(const Node& node, const std::filesystem::path& folder) {
  ScanConfig scan;
  MapReader reader(node, "a scan");
  scan.file = resolved(reader.required("file"), folder);
  if (const Node* units = reader.optional("units")) scan.units = parse_units(*units);
  if (const Node* pose = reader.optional("pose")) scan.pose = parse_pose(*pose);
  if (const Node* columns = reader.optional("columns")) scan.columns = parse_columns(*columns);
  reader.finish();
  return scan;
}

RegisterConfig parse_register(const Node& node) {
  RegisterConfig config;
  if (node.kind == Node::Kind::null) return config;
  MapReader reader(node, "register");
  int method = 0;
  reader.read_choice("method", method, {"gicp", "point_to_plane", "icp"});
  config.method = static_cast<RegisterConfig::Method>(method);
  int guess = 0;
  reader.read_choice("guess", guess, {"poses", "features"});
  config.guess = static_cast<RegisterConfig::Guess>(guess);
  read_mm(reader, "max_distance_mm", config.max_distance_m, kSmallest, kAny);
  read_mm(reader, "voxel_mm", config.voxel_m, kSmallest, kAny);
  reader.read("min_overlap", config.min_overlap, 0.01, 1.0);
  reader.finish();
  if (config.max_distance_m > 0 && config.max_distance_m < config.voxel_m) {
    throw yaml::error_at(node, "max_distance_mm is below voxel_mm", "voxel_mm <= max_distance_mm");
  }
  return config;
}

OrientationConfig parse_orientation(const Node& node) {
  OrientationConfig orientation;
  MapReader reader(node, "orientation");
  const int form = exclusive(reader, {"look_from", "euler_deg", "quaternion", "matrix", "face"});
  double scale = 1.0;
  reader.read("scale", scale, 1e-9, 1e9);
  const Node* up = reader.optional("up");
  int face = 0;
  if (form == 4) reader.read_choice("face", face, {"auto", "plane", "principal"});
  if (const Node* regions = reader.optional("regions_matrix")) orientation.regions_scan_to_grid = matrix(*regions);
  reader.finish();
  if (form == 4) {
    orientation.face = static_cast<OrientationConfig::Face>(face);
    orientation.face_scale = scale;
    if (up == nullptr) return orientation;
    orientation.face_up = vector(*up);
    if (orientation.face_up->isZero(0.0)) throw yaml::error_at(*up, "'up' has no direction", "a vector of some length");
    return orientation;
  }
  if (up != nullptr && form > 0) throw yaml::error_at(*up, "'up' belongs to 'look_from'", "leave it out");
  Eigen::Matrix4d& m = orientation.scan_to_grid;
  if (form == 3) {
    if (const Node* given = node.find("scale")) {
      throw yaml::error_at(*given, "'matrix' and 'scale' contradict", "the scale within the matrix");
    }
    m = matrix(*node.find("matrix"));
  } else if (form == 1 || form == 2) {
    m.topLeftCorner<3, 3>() =
        scale * (form == 1 ? euler(*node.find("euler_deg")) : quaternion(*node.find("quaternion")));
  } else {
    const Eigen::Vector3d direction = form == 0 ? vector(*node.find("look_from")) : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d up_direction = up != nullptr ? vector(*up) : Eigen::Vector3d::UnitY();
    try {
      m = look_from(direction, up_direction, scale);
    } catch (const Error& error) {
      throw yaml::error_at(up != nullptr ? *up : node, error.wrong(), error.expected());
    }
  }
  return orientation;
}

GridConfig parse_grid(const Node& node) {
  GridConfig grid;
  MapReader reader(node, "grid");
  exclusive(reader, {"size", "spacing_mm"});
  reader.read("size", grid.size, 2, 1 << 20);
  read_mm(reader, "spacing_mm", grid.spacing_m, kSmallest, kAny);
  double noise_m = -1.0;
  read_mm(reader, "noise_mm", noise_m, 0.0, kAny);
  if (noise_m >= 0.0) grid.noise_m = noise_m;
  if (const Node* bounds = reader.optional("bounds_m")) grid.bounds_m = read_box(*bounds);
  reader.read("colour", grid.colour);
  reader.read("intensity", grid.intensity);
  reader.finish();
  return grid;
}

TextureConfig parse_texture(const Node& node) {
  TextureConfig texture;
  if (node.kind == Node::Kind::null) return texture;
  MapReader reader(node, "texture");
  read_mm(reader, "sigma_space_mm", texture.sigma_space_m, kSmallest, kAny);
  read_mm(reader, "sigma_range_mm", texture.sigma_range_m, kSmallest, kAny);
  int method = 0;
  reader.read_choice("method", method, {"direct", "opencv"});
  texture.method = static_cast<TextureConfig::Method>(method);
  reader.finish();
  return texture;
}

FrictionConfig parse_friction(const Node& node) {
  FrictionConfig friction;
  if (node.kind == Node::Kind::null) return friction;
  MapReader reader(node, "friction");
  int law = 0;
  reader.read_choice("law", law, {"curvature", "paper", "constant"});
  friction.law = static_cast<FrictionConfig::Law>(law);
  reader.read("mu_static", friction.mu_static, 0.0, kMostFriction);
  reader.read("mu_0", friction.mu_0, 0.0, kMostFriction);
  reader.read("mu_max", friction.mu_max, 0.0, kMostFriction);
  read_mm(reader, "scale_mm", friction.scale_m, kSmallest, kAny);
  if (const Node* c = reader.optional("c_m")) {
    friction.c_m = yaml::to_double(*c);
    if (*friction.c_m < 0.0) throw yaml::error_at(*c, "c_m is negative", "metres, 0 or more");
  }
  reader.finish();
  if (friction.mu_0 > friction.mu_max) {
    throw yaml::error_at(node, "mu_0 is above mu_max", "mu_0 <= mu_max");
  }
  return friction;
}

CheckConfig parse_check(const Node& node) {
  CheckConfig check;
  if (node.kind == Node::Kind::null) return check;
  MapReader reader(node, "check");
  if (const Node* samples = reader.optional("samples")) {
    if (samples->is_scalar() && samples->scalar == "all") {
      check.samples = 0;
    } else {
      check.samples = yaml::to_integer(*samples);
      if (check.samples < 1) throw yaml::error_at(*samples, "samples is " + samples->scalar, "1 or more, or all");
    }
  }
  reader.finish();
  return check;
}

HapticsConfig parse_haptics(const Node& node) {
  HapticsConfig haptics;
  MapReader reader(node, "haptics");
  reader.read("stiffness_n_per_m", haptics.stiffness_n_per_m, kLeastStiffness_n_per_m, kMostStiffness_n_per_m);
  int solver = 0;
  reader.read_choice("solver", solver, {"exact", "paper"});
  haptics.solver = static_cast<HapticsConfig::Solver>(solver);
  int surface = 0;
  reader.read_choice("surface", surface, {"bilinear", "c1"});
  haptics.surface = static_cast<HapticsConfig::Surface>(surface);
  int creases = static_cast<int>(haptics.creases);
  reader.read_choice("creases", creases, {"sharp", "rounded"});
  haptics.creases = static_cast<HapticsConfig::Creases>(creases);
  int beyond = static_cast<int>(haptics.beyond);
  reader.read_choice("beyond", beyond, {"continued", "falls", "rim"});
  haptics.beyond = static_cast<HapticsConfig::Beyond>(beyond);
  reader.read("rate_hz", haptics.rate_hz, 100.0, 10000.0);
  read_mm(reader, "resolution_mm", haptics.resolution_m, 1e-6, 1000.0);
  read_mm(reader, "tip_radius_mm", haptics.tip_radius_m, 0.0, 2.0);
  reader.read("impact", haptics.impact);
  reader.read("grain", haptics.grain);
  read_material(reader, "material", haptics.material);
  reader.finish();
  return haptics;
}

PartTouch parse_touch(MapReader& reader, const Node& node) {
  PartTouch touch;
  read_number(reader, "stiffness_n_per_m", touch.stiffness_n_per_m, kLeastStiffness_n_per_m, kMostStiffness_n_per_m);
  read_number(reader, "mu_dynamic", touch.mu_dynamic, 0.0, kMostFriction);
  read_number(reader, "mu_static", touch.mu_static, 0.0, kMostFriction);
  if (reader.optional("material") != nullptr) {
    touch.material = Material::granite;
    read_material(reader, "material", *touch.material);
  }
  if (touch.mu_static && !touch.mu_dynamic) {
    throw yaml::error_at(*node.find("mu_static"), "a part has mu_static without mu_dynamic", "mu_dynamic beside it");
  }
  if (touch.mu_static && *touch.mu_static < *touch.mu_dynamic) {
    throw yaml::error_at(node, "mu_static is below mu_dynamic", "mu_dynamic <= mu_static");
  }
  return touch;
}

void require_friction(const Node& parts, const Config& config) {
  if (config.friction) return;
  for (const Node& part : parts.items) {
    if (const Node* mu = part.find("mu_dynamic")) {
      throw yaml::error_at(*mu, "a part has friction and the scene has none",
                           "the block 'friction', for instance {law: constant, mu_static: 0, mu_0: 0}");
    }
  }
}

void require_labels(const Node& parts, const Config& config) {
  if (config.audio && config.audio->labels) return;
  for (const Node& part : parts.items) {
    if (const Node* label = part.find("label")) {
      throw yaml::error_at(*label, "a part has a label and the scene no label image",
                           "the image in the block 'audio', for instance {labels: {file: labels.png}}");
    }
  }
}

std::vector<PartConfig> parse_parts(const Node& node) {
  if (!node.is_sequence())
    throw yaml::error_at(node, "parts is not a list",
                         "a list of {name, say, box_m}; or polygon_m or label instead of box_m");
  std::vector<PartConfig> parts;
  for (const Node& item : node.items) {
    MapReader reader(item, "a part");
    PartConfig part;
    part.name = yaml::to_text(reader.required("name"));
    if (part.name.find_first_not_of(" \t\n\r") == std::string::npos)
      throw yaml::error_at(*item.find("name"), "the name of a part is empty", "words by which it is announced");
    part.say = part.name;
    reader.read("say", part.say);
    reader.read("more", part.more);
    // A part without words would be announced by silence.
    if (part.say.empty()) part.say = part.name;
    const int where = exclusive(reader, {"box_m", "polygon_m", "label"});
    if (where == 0) part.box_m = read_box(*item.find("box_m"));
    if (where == 1) part.polygon_m = read_polygon(*item.find("polygon_m"));
    if (where == 2) part.label = read_label(*item.find("label"));
    part.touch = parse_touch(reader, item);
    reader.finish();
    if (where < 0) throw yaml::error_at(item, "part '" + part.name + "' has no place", "box_m, polygon_m or label");
    parts.push_back(std::move(part));
  }
  return parts;
}

std::optional<SpeechConfig> parse_speech(const Node& node) {
  SpeechConfig speech;
  if (node.is_scalar()) return yaml::to_bool(node) ? std::optional(speech) : std::nullopt;
  MapReader reader(node, "speech");
  if (const Node* language = reader.optional("language")) {
    speech.language = yaml::to_text(*language);
    const std::vector<std::string> known = Phrases::languages();
    if (std::find(known.begin(), known.end(), speech.language) == known.end())
      throw yaml::error_at(*language, "no texts are there in the language '" + speech.language + "'",
                           fmt::format("{}", fmt::join(known, " or ")));
  }
  reader.read("voice", speech.voice);
  reader.read("words_per_minute", speech.words_per_minute, 80, 450);
  reader.finish();
  return speech;
}

ViewerConfig parse_viewer(const Node& node) {
  ViewerConfig viewer;
  MapReader reader(node, "viewer");
  int colour = 0;
  reader.read_choice("colour", colour, {ViewerConfig::kColourNames.begin(), ViewerConfig::kColourNames.end()});
  viewer.colour = static_cast<ViewerConfig::Colour>(colour);
  int stereo = 0;
  reader.read_choice("stereo", stereo, {ViewerConfig::kStereoNames.begin(), ViewerConfig::kStereoNames.end()});
  viewer.stereo = static_cast<ViewerConfig::Stereo>(stereo);
  int side = 0;
  reader.read_choice("overview", side, {ViewerConfig::kSideNames.begin(), ViewerConfig::kSideNames.end()});
  viewer.overview = static_cast<ViewerConfig::Side>(side);
  reader.finish();
  return viewer;
}

}  // namespace

Eigen::Matrix4d look_from(const Eigen::Vector3d& direction, const Eigen::Vector3d& up, double scale) {
  if (!(direction.norm() > 0.0)) throw usage_error("look_from has no direction", "a vector that is not 0 0 0");
  const Eigen::Vector3d z = direction.normalized();
  const Eigen::Vector3d x = up.cross(z);
  if (!(x.norm() > 1e-6 * up.norm())) {
    throw usage_error("up is parallel to look_from", "an up that points elsewhere than the viewer");
  }
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = scale * x.normalized().transpose();
  m.block<1, 3>(1, 0) = scale * z.cross(x.normalized()).transpose();
  m.block<1, 3>(2, 0) = scale * z.transpose();
  return m;
}

Config parse_config(const Node& root, const std::filesystem::path& folder) {
  Config config;
  MapReader reader(root, "the configuration");
  const Node& scans = reader.required("scans");
  if (!scans.is_sequence()) throw yaml::error_at(scans, "scans is not a list", "a list of {file, units, pose}");
  for (const Node& item : scans.items) config.scans.push_back(parse_scan(item, folder));
  if (config.scans.empty()) throw yaml::error_at(scans, "scans is empty", "at least one {file: ...}");
  if (const Node* filters = reader.optional("filters")) config.filters = parse_filters(*filters);
  if (const Node* node = reader.optional("register")) config.registration = parse_register(*node);
  if (const Node* node = reader.optional("orientation")) config.orientation = parse_orientation(*node);
  if (const Node* node = reader.optional("grid")) config.grid = parse_grid(*node);
  if (const Node* node = reader.optional("around")) {
    config.around = AroundConfig{};
    if (node->kind != Node::Kind::null) MapReader(*node, "around").finish();
  }
  if (const Node* node = reader.optional("unroll")) config.unroll = parse_unroll(*node, config);
  if (const Node* node = reader.optional("fill")) {
    config.fill = FillConfig{};
    if (node->kind != Node::Kind::null) {
      MapReader keys(*node, "fill");
      read_mm(keys, "max_gap_mm", config.fill->max_gap_m, 0.0, kAny);
      keys.finish();
    }
  }
  if (const Node* node = reader.optional("texture")) config.texture = parse_texture(*node);
  if (const Node* node = reader.optional("friction")) config.friction = parse_friction(*node);
  if (config.friction && !config.texture) config.texture = TextureConfig{};
  if (const Node* node = reader.optional("levels")) {
    MapReader keys(*node, "levels");
    keys.read("window", config.levels.window, 16, 8192);
    keys.finish();
  }
  if (const Node* node = reader.optional("check")) config.check = parse_check(*node);
  if (const Node* node = reader.optional("haptics")) config.haptics = parse_haptics(*node);
  if (const Node* node = reader.optional("parts")) {
    config.parts = parse_parts(*node);
    require_friction(*node, config);
  }
  if (const Node* node = reader.optional("audio")) config.audio = parse_audio(*node, folder);
  if (const Node* node = reader.optional("parts")) require_labels(*node, config);
  if (const Node* node = reader.optional("speech")) config.speech = parse_speech(*node);
  if (const Node* node = reader.optional("guide")) config.guide = parse_guide(*node);
  if (const Node* node = reader.optional("cues")) config.cues = parse_cues(*node);
  if (const Node* node = reader.optional("viewer")) config.viewer = parse_viewer(*node);
  finish_root(reader, root);
  return config;
}

bool describes_scene(const Node& root) {
  return root.is_map() && std::all_of(kSceneKeys.begin(), kSceneKeys.end(),
                                      [&](std::string_view key) { return root.find(key) != nullptr; });
}

Config load_config(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  Node root = yaml::parse_file(file);
  if (describes_scene(root)) {
    std::erase_if(root.entries, [](const yaml::Entry& entry) {
      return std::find(kSceneKeys.begin(), kSceneKeys.end(), entry.key) != kSceneKeys.end();
    });
  }
  override_keys(root, settings);
  return parse_config(root, file.parent_path());
}

}  // namespace sparsha::scene
