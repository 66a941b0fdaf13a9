// The configuration back as YAML, so that scene.yaml can be read and built again.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/text/text.h"
#include "base/yaml/yaml_text.h"
#include "scene/config/config.h"
#include "scene/config/reader.h"
#include "scene/config/text_editor.h"

namespace sparsha::scene {
namespace {

// Shortest text that reads back to the same double.
// Metres to the unit of a key, by the shortest decimal that reads back (times 1e-3) to the same metres.
std::string millimetres(double metres) {
  const double scaled = metres * 1000.0;
  for (int digits = 1; digits <= 17; ++digits) {
    const double rounded = std::stod(fmt::format("{:.{}g}", scaled, digits));
    if (rounded * 1e-3 == metres) return exact_text(rounded);
  }
  return exact_text(scaled);
}

std::string matrix(const Eigen::Matrix4d& m) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) text += (text.size() > 1 ? ", " : "") + exact_text(m(row, column));
  return text + "]";
}

std::string box(const std::array<double, 4>& b) {
  return fmt::format("[{}, {}, {}, {}]", exact_text(b[0]), exact_text(b[1]), exact_text(b[2]), exact_text(b[3]));
}

std::string vector(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", exact_text(v.x()), exact_text(v.y()), exact_text(v.z()));
}

std::string units(const Units& value) {
  if (value.unit == LengthUnit::automatic) return {};
  const std::string name = to_string(value.unit);
  return value.unit == LengthUnit::longest_side ? "{" + name + ": " + millimetres(value.longest_side_m) + "}" : name;
}

template <typename Method>
const char* method(Method value) {
  return value == Method::pcl ? "pcl" : "fast";
}

std::string filter_keys(const CropConfig& crop) {
  return fmt::format("min_m: {}, max_m: {}", vector(crop.min_m), vector(crop.max_m));
}

std::string filter_keys(const VoxelConfig& voxel) { return "leaf_mm: " + millimetres(voxel.leaf_m); }

std::string filter_keys(const OutlierConfig& outliers) {
  return fmt::format("neighbours: {}, sigma: {}, method: {}", outliers.neighbours, exact_text(outliers.sigma),
                     method(outliers.method));
}

std::string filter_keys(const RadiusOutlierConfig& outliers) {
  return fmt::format("radius_mm: {}, neighbours: {}, method: {}", millimetres(outliers.radius_m), outliers.neighbours,
                     method(outliers.method));
}

std::string filter_keys(const PassConfig& pass) {
  std::string text = fmt::format("axis: {}", "xyz"[pass.axis]);
  if (std::isfinite(pass.min_m)) text += ", min_m: " + exact_text(pass.min_m);
  if (std::isfinite(pass.max_m)) text += ", max_m: " + exact_text(pass.max_m);
  return text;
}

std::string filter_keys(const RemovePlaneConfig& plane) {
  static constexpr std::array<std::string_view, 3> kSides{"below", "above", "both"};
  return fmt::format("distance_mm: {}, side: {}, normal: {}, max_angle_deg: {}", millimetres(plane.distance_m),
                     kSides[static_cast<std::size_t>(plane.side)], vector(plane.normal),
                     exact_text(plane.max_angle_deg));
}

std::string filter_keys(const KeepConfig& keep) {
  return fmt::format("{}, tolerance_mm: {}, method: {}",
                     keep.nearest_to_m ? "nearest_to: " + vector(*keep.nearest_to_m) : "cluster: largest",
                     millimetres(keep.tolerance_m), method(keep.method));
}

std::string filter_keys(const SmoothConfig& smooth) {
  return fmt::format("radius_mm: {}, order: {}, method: {}", millimetres(smooth.radius_m), smooth.order,
                     method(smooth.method));
}

std::string filter_keys(const ThinConfig& thin) { return fmt::format("points_per_node: {}", thin.points_per_node); }

std::string filter_keys(const FieldConfig& field) {
  std::string text = "name: " + yaml::quoted(field.name);
  if (std::isfinite(field.min)) text += ", min: " + exact_text(field.min);
  if (std::isfinite(field.max)) text += ", max: " + exact_text(field.max);
  return text;
}

std::string filter_keys(const ClassesConfig& classes) {
  return fmt::format("{}: [{}]", classes.keep.empty() ? "drop" : "keep",
                     fmt::join(classes.keep.empty() ? classes.drop : classes.keep, ", "));
}

std::string filter_text(const FilterConfig& filter) {
  const std::string keys = std::visit([](const auto& config) { return filter_keys(config); }, filter);
  return "  - " + filter_name(filter) + ": {" + keys + "}\n";
}

std::string orientation_text(const OrientationConfig& orientation) {
  const std::string regions =
      orientation.regions_scan_to_grid ? ", regions_matrix: " + matrix(*orientation.regions_scan_to_grid) : "";
  if (!orientation.face) return "orientation: {matrix: " + matrix(orientation.scan_to_grid) + regions + "}\n";
  static constexpr std::array<std::string_view, 3> kFaces{"auto", "plane", "principal"};
  std::string text = fmt::format("orientation: {{face: {}", kFaces[static_cast<std::size_t>(*orientation.face)]);
  if (orientation.face_up) text += ", up: " + vector(*orientation.face_up);
  if (orientation.face_scale != 1.0) text += ", scale: " + exact_text(orientation.face_scale);
  return text + regions + "}\n";
}

std::string register_text(const RegisterConfig& config) {
  static constexpr std::array<std::string_view, 3> kMethods{"gicp", "point_to_plane", "icp"};
  std::string text = fmt::format("register: {{method: {}", kMethods[static_cast<std::size_t>(config.method)]);
  if (config.guess == RegisterConfig::Guess::features) text += ", guess: features";
  if (config.max_distance_m > 0) text += ", max_distance_mm: " + millimetres(config.max_distance_m);
  if (config.voxel_m > 0) text += ", voxel_mm: " + millimetres(config.voxel_m);
  return text + ", min_overlap: " + exact_text(config.min_overlap) + "}\n";
}

std::string grid_text(const GridConfig& grid) {
  std::string text = "grid: {";
  const auto add = [&](const std::string& entry) { text += (text.back() == '{' ? "" : ", ") + entry; };
  if (grid.size > 0) add(fmt::format("size: {}", grid.size));
  if (grid.spacing_m > 0) add("spacing_mm: " + millimetres(grid.spacing_m));
  if (grid.noise_m) add("noise_mm: " + millimetres(*grid.noise_m));
  if (grid.bounds_m) add("bounds_m: " + box(*grid.bounds_m));
  if (grid.colour) add("colour: true");
  if (grid.intensity) add("intensity: true");
  return text + "}\n";
}

std::string friction_text(const FrictionConfig& friction) {
  static constexpr std::array<std::string_view, 3> kLaws{"curvature", "paper", "constant"};
  std::string text = fmt::format("friction: {{law: {}, mu_static: {}, mu_0: {}, mu_max: {}",
                                 kLaws[static_cast<std::size_t>(friction.law)], exact_text(friction.mu_static),
                                 exact_text(friction.mu_0), exact_text(friction.mu_max));
  if (friction.scale_m > 0) text += ", scale_mm: " + millimetres(friction.scale_m);
  if (friction.c_m) text += ", c_m: " + exact_text(*friction.c_m);
  return text + "}\n";
}

std::string sound_text(const ModalConfig& modal) {
  if (modal.modes.empty())
    return fmt::format("modal: {{frequency_hz: {}, decay_s: {}}}", exact_text(modal.frequency_hz),
                       exact_text(modal.decay_s));
  std::string text = "modal: {modes: [";
  for (const ModeConfig& mode : modal.modes) {
    text += fmt::format("{}{{frequency_hz: {}, decay_s: {}, level_db: {}}}", text.back() == '[' ? "" : ", ",
                        exact_text(mode.frequency_hz), exact_text(mode.decay_s), exact_text(mode.level_db));
  }
  return text + "]}";
}

std::string sound_text(const std::filesystem::path& clip) { return "clip: " + yaml::quoted(clip.generic_string()); }

std::string sound_text(const MaterialSoundConfig& sound) {
  std::string text = fmt::format("material: {{name: {}", touch_of(sound.material).name);
  if (sound.frequency_hz) text += ", frequency_hz: " + exact_text(*sound.frequency_hz);
  if (sound.damping) text += ", damping: " + exact_text(*sound.damping);
  if (sound.brightness) text += ", brightness: " + exact_text(*sound.brightness);
  return text + "}";
}

template <std::size_t kCount>
std::string points(const std::vector<std::array<double, kCount>>& places_m) {
  std::string text;
  for (const auto& place : places_m) {
    text += text.empty() ? "[" : ", [";
    for (std::size_t axis = 0; axis < kCount; ++axis) text += (axis > 0 ? ", " : "") + exact_text(place[axis]);
    text += "]";
  }
  return "[" + text + "]";
}

// Of what has no box of the grid.
template <class Placed>
std::string outline_text(const Placed& placed) {
  std::string text;
  if (placed.solid_m) {
    text += ", box_m: [";
    for (std::size_t k = 0; k < placed.solid_m->size(); ++k)
      text += (k > 0 ? ", " : "") + exact_text((*placed.solid_m)[k]);
    text += "]";
  }
  if (!placed.polygon_m.empty()) text += ", polygon_m: " + points(placed.polygon_m);
  if (placed.label) text += fmt::format(", label: {}", *placed.label);
  return text;
}

std::string region_text(const AudioRegionConfig& region) {
  std::string text = "    - {name: " + yaml::quoted(region.name);
  if (region.box_m) text += ", box_m: " + box(*region.box_m);
  text += outline_text(region);
  text += ", " + std::visit([](const auto& sound) { return sound_text(sound); }, region.sound);
  if (region.loop == AudioRegionConfig::Loop::one_period) text += ", loop: one_period";
  return text + "}\n";
}

std::string audio_text(const AudioConfig& audio) {
  std::string text = audio.find_pillars ? "  find: pillars\n" : "";
  if (!audio.regions.empty()) text += "  regions:\n";
  for (const AudioRegionConfig& region : audio.regions) text += region_text(region);
  if (audio.labels) {
    text += "  labels: {file: " + yaml::quoted(audio.labels->file.generic_string());
    if (audio.labels->bounds_m) text += ", bounds_m: " + box(*audio.labels->bounds_m);
    text += "}\n";
  }
  if (audio.material) text += "  " + sound_text(*audio.material) + "\n";
  if (audio.friction_sound_gain) {
    text += fmt::format("  friction_sound: {{gain: {}{}}}\n", exact_text(*audio.friction_sound_gain),
                        audio.friction_sound_grain ? "" : ", grain: off");
  }
  return text.empty() ? "audio: {}\n" : "audio:\n" + text;
}

// What is left at its default is not written: scenes without it stay what they were.
std::string invented_text(const HapticsConfig& haptics) {
  std::string text;
  if (haptics.impact) text += ", impact: on";
  if (haptics.grain) text += ", grain: on";
  if (haptics.material != Material::granite) text += fmt::format(", material: {}", touch_of(haptics.material).name);
  return text;
}

std::string touch_text(const PartTouch& touch) {
  std::string text;
  if (touch.stiffness_n_per_m) text += ", stiffness_n_per_m: " + exact_text(*touch.stiffness_n_per_m);
  if (touch.mu_dynamic) text += ", mu_dynamic: " + exact_text(*touch.mu_dynamic);
  if (touch.mu_static) text += ", mu_static: " + exact_text(*touch.mu_static);
  if (touch.material) text += fmt::format(", material: {}", touch_of(*touch.material).name);
  return text;
}

std::string guide_text(const GuideConfig& guide) {
  std::string line;
  if (!guide.line_m.empty()) line = ", line_m: " + points(guide.line_m);
  if (!guide.line_in_space_m.empty()) line = ", line_m: " + points(guide.line_in_space_m);
  return fmt::format("guide: {{path: {}, force_n: {}, speed_mm_per_s: {}{}}}\n",
                     GuideConfig::kPathNames[static_cast<std::size_t>(guide.path)], exact_text(guide.force_n),
                     millimetres(guide.speed_m_per_s), line);
}

std::string cues_text(const CuesConfig& cues) {
  std::string text = "cues: {";
  for (std::size_t cue = 0; cue < kCues; ++cue) {
    const char* kind = cues.sound[cue] ? (cues.tick[cue] ? "both" : "sound") : (cues.tick[cue] ? "tick" : "off");
    text += fmt::format("{}: {}, ", kCueNames[cue], kind);
  }
  return text + (cues.lost ? "lost: on}\n" : "lost: off}\n");
}

}  // namespace

std::string to_string(LengthUnit unit) {
  static constexpr std::array<const char*, 7> kNames{"unknown", "m", "cm", "mm", "ft", "us_ft", "longest_side_mm"};
  return kNames[static_cast<std::size_t>(unit)];
}

std::string box_text(const std::array<double, 4>& box_m) { return box(box_m); }

std::string part_text(const PartConfig& part) {
  return "{name: " + yaml::quoted(part.name) + ", say: " + yaml::quoted(part.say) +
         (part.is_box() ? ", box_m: " + box(part.box_m) : outline_text(part)) + touch_text(part.touch) +
         (part.more.empty() ? "" : ", more: " + yaml::quoted(part.more)) + "}";
}

std::string to_yaml(const Config& config) {
  std::string text = config.scans.empty() ? "scans: []\n" : "scans:\n";
  for (const ScanConfig& scan : config.scans) {
    text += "  - file: " + yaml::quoted(scan.file.generic_string()) + "\n";
    if (const std::string unit = units(scan.units); !unit.empty()) text += "    units: " + unit + "\n";
    if (scan.pose != Eigen::Matrix4d::Identity()) text += "    pose: {matrix: " + matrix(scan.pose) + "}\n";
    if (!scan.columns.empty()) text += fmt::format("    columns: [{}]\n", fmt::join(scan.columns, ", "));
  }
  if (!config.filters.empty()) text += "filters:\n";
  for (const FilterConfig& filter : config.filters) text += filter_text(filter);
  if (config.registration) text += register_text(*config.registration);
  text += orientation_text(config.orientation);
  text += grid_text(config.grid);
  if (config.around) text += "around: {}\n";
  if (config.unroll) text += unroll_text(*config.unroll);
  if (config.fill) text += "fill: {max_gap_mm: " + millimetres(config.fill->max_gap_m) + "}\n";
  if (config.texture) {
    text += fmt::format("texture: {{sigma_space_mm: {}, sigma_range_mm: {}, method: {}}}\n",
                        millimetres(config.texture->sigma_space_m), millimetres(config.texture->sigma_range_m),
                        config.texture->method == TextureConfig::Method::opencv ? "opencv" : "direct");
  }
  if (config.friction) text += friction_text(*config.friction);
  text += fmt::format("levels: {{window: {}}}\n", config.levels.window);
  if (config.check) {
    text += config.check->samples == 0 ? "check: {samples: all}\n"
                                       : fmt::format("check: {{samples: {}}}\n", config.check->samples);
  }
  const HapticsConfig& haptics = config.haptics;
  text += fmt::format(
      "haptics: {{stiffness_n_per_m: {}, solver: {}, surface: {}, creases: {}, beyond: {}, rate_hz: {}, "
      "resolution_mm: {}, tip_radius_mm: {}{}}}\n",
      exact_text(haptics.stiffness_n_per_m), haptics.solver == HapticsConfig::Solver::exact ? "exact" : "paper",
      haptics.surface == HapticsConfig::Surface::bilinear ? "bilinear" : "c1",
      haptics.creases == HapticsConfig::Creases::sharp ? "sharp" : "rounded",
      std::array{"continued", "falls", "rim"}[static_cast<std::size_t>(haptics.beyond)], exact_text(haptics.rate_hz),
      millimetres(haptics.resolution_m), millimetres(haptics.tip_radius_m), invented_text(haptics));
  if (!config.parts.empty()) text += "parts:\n";
  for (const PartConfig& part : config.parts) {
    text += "  - " + part_text(part) + "\n";
  }
  if (config.audio) text += audio_text(*config.audio);
  if (config.speech) {
    text += fmt::format("speech: {{language: {}, words_per_minute: {}{}}}\n", config.speech->language,
                        config.speech->words_per_minute,
                        config.speech->voice.empty() ? "" : ", voice: " + yaml::quoted(config.speech->voice));
  }
  if (config.guide) text += guide_text(*config.guide);
  if (config.cues) text += cues_text(*config.cues);
  text += fmt::format("viewer: {{colour: {}, stereo: {}{}}}\n",
                      ViewerConfig::kColourNames[static_cast<std::size_t>(config.viewer.colour)],
                      ViewerConfig::kStereoNames[static_cast<std::size_t>(config.viewer.stereo)],
                      config.viewer.overview == ViewerConfig::Side::left ? ", overview: left" : "");
  return text;
}

}  // namespace sparsha::scene
