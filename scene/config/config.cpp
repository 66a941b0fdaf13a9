// Reads every block of the configuration and refuses what it does not know.
#include "scene/config/block_hint.h"
#include "scene/config/override.h"
#include "scene/config/placement.h"
#include "scene/config/reader.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/ranges.h>

#include "base/phrases/phrases.h"
#include "scene/config/config.h"

namespace sparsha::scene {
namespace {

using yaml::MapReader;
using yaml::Node;

constexpr std::array<std::string_view, 3> kSceneKeys = {"scene", "origin_m", "scan_from_grid"};
constexpr double kLeastStiffness_n_per_m = 1.0;
constexpr double kMostStiffness_n_per_m = 1e5;
constexpr double kMostFriction = 10.0;

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
    constexpr double kMost_m = 1e12;  // what a scene's description may have
    if (*friction.c_m > kMost_m) throw yaml::error_at(*c, "c_m is beyond 1e12 m", "metres, 0 to 1e12");
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

/// `what`: "a part".
void require_labels(const Node& places, const char* what, const Config& config) {
  if (config.audio && config.audio->labels) return;
  for (const Node& place : places.items) {
    if (const Node* label = place.find("label")) {
      throw yaml::error_at(*label, std::string(what) + " has a label and the scene no label image",
                           "the image in the block 'audio', for instance {labels: {file: labels.png}}");
    }
  }
}

/// Boxes in space belong to whole objects: of one view nothing tells what is behind.
void require_around(const Node& places, const Config& config) {
  if (config.around) return;
  for (const Node& place : places.items) {
    const Node* box = place.find("box_m");
    if (box != nullptr && read_solid_box(*box))
      throw yaml::error_at(*box, "a box of six numbers needs the whole object",
                           "the block 'around: {}', or [xmin, ymin, xmax, ymax] of the grid frame");
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
    if (where == 0) part.solid_m = read_solid_box(*item.find("box_m"));
    if (where == 0 && !part.solid_m) part.box_m = read_box(*item.find("box_m"));
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
    require_around(*node, config);
  }
  if (const Node* node = reader.optional("audio")) {
    config.audio = parse_audio(*node, folder);
    if (const Node* regions = node->find("regions")) {
      require_around(*regions, config);
      require_labels(*regions, "an audio region", config);
    }
  }
  if (const Node* node = reader.optional("parts")) require_labels(*node, "a part", config);
  if (const Node* node = reader.optional("speech")) config.speech = parse_speech(*node);
  if (const Node* node = reader.optional("guide")) config.guide = parse_guide(*node);
  if (config.guide && !config.guide->line_in_space_m.empty() && !config.around)
    throw yaml::error_at(*root.find("guide")->find("line_m"),
                         "a line of points with three numbers needs the whole object",
                         "the block 'around: {}', or points [x, y] of the grid frame");
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
  const bool of_scene = describes_scene(root);
  if (of_scene) {
    std::erase_if(root.entries, [](const yaml::Entry& entry) {
      return std::find(kSceneKeys.begin(), kSceneKeys.end(), entry.key) != kSceneKeys.end();
    });
  }
  override_keys(root, settings);
  Config config = parse_config(root, file.parent_path());
  // A scene's last part may have been taken away in the viewer.
  if (!of_scene && config.guide && config.guide->path == GuideConfig::Path::part && config.parts.empty())
    throw yaml::error_at(*root.find("guide"), "the guide leads along parts, and there are none",
                         "the block 'parts', or path: outline");
  return config;
}

}  // namespace sparsha::scene
