// Scene folders: scene.yaml and one TIFF a layer and level (docs/formats.md).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"
#include "base/files/paths.h"
#include "base/text/text.h"
#include "base/yaml/yaml.h"
#include "scene/area/regions.h"
#include "scene/folder/folder.h"
#include "scene/folder/heights.h"
#include "scene/folder/layer_file.h"
#include "scene/folder/layers.h"
#include "scene/folder/sheets_file.h"
#include "scene/folder/vrt_file.h"
#include "scene/ground/window_lattice.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace fs = std::filesystem;

namespace {

constexpr int kFormatVersion = 1;
constexpr const char* kErrorLayer = "error.tif";
constexpr const char* kVrtFile = "level.vrt";
constexpr const char* kChartsFile = "charts.bin";

fs::path level_folder(const fs::path& folder, std::size_t level) { return folder / fmt::format("level-{}", level); }

std::string numbers(std::initializer_list<double> values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + exact_text(value);
  return text + "]";
}

// As scene.yaml lists them; each is a file in a level's folder.
std::vector<std::string> layer_names(const SceneDescription& scene) {
  std::vector<std::string> names{"height", "mask"};
  for (const OptionalLayer& layer : kFloatLayers)
    if (scene.*(layer.present)) names.emplace_back(layer.name);
  if (scene.has_colour) names.emplace_back("colour");
  return names;
}

// A clip's name without the number that a scene has put before it.
std::string plain_stem(const fs::path& clip) {
  std::string stem = clip.stem().string();
  const std::size_t digits = stem.find_first_not_of("0123456789");
  if (digits != std::string::npos && digits > 0 && stem[digits] == '-') stem.erase(0, digits + 1);
  return stem;
}

// Clips and label images get names of their own within the folder; the configuration then names the copies.
Config copy_clips(Config config, const fs::path& folder) {
  if (!config.audio) return config;
  std::map<fs::path, fs::path> copies;
  for (AudioRegionConfig& region : config.audio->regions) {
    auto* clip = std::get_if<fs::path>(&region.sound);
    if (clip == nullptr) continue;
    if (!copies.contains(*clip)) {
      const fs::path copy =
          fs::path("audio") / fmt::format("{}-{}{}", copies.size(), plain_stem(*clip), clip->extension().string());
      const std::string bytes = read_file(*clip, std::size_t{1} << 30U);
      fs::create_directories(folder / "audio");
      write_file(folder / copy, bytes);
      copies[*clip] = copy;
    }
    *clip = copies[*clip];
  }
  if (config.audio->labels) {
    const fs::path copy = fs::path("audio") / "labels.png";
    const std::string bytes = read_file(config.audio->labels->file, std::size_t{1} << 30U);
    fs::create_directories(folder / "audio");
    write_file(folder / copy, bytes);
    config.audio->labels->file = copy;
  }
  return config;
}

std::string scene_yaml(const SceneDescription& scene, const fs::path& folder) {
  Config config = copy_clips(scene.config, folder);
  // Scans in the order of their bytes, so that the order of files does not change the scene.
  std::vector<std::size_t> order(scene.sources.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return scene.sources[a].sha256 < scene.sources[b].sha256; });
  if (order.size() == config.scans.size()) {
    std::vector<ScanConfig> sorted;
    for (const std::size_t i : order) sorted.push_back(config.scans[i]);
    config.scans = std::move(sorted);
  }
  for (ScanConfig& scan : config.scans) scan.file = path_from(folder, scan.file);

  std::string text = "# A Sparsha scene: the resolved configuration, and below it what was made of it.\n";
  text += to_yaml(config);
  text += fmt::format("scene:\n  version: {}\n", kFormatVersion);
  const Lattice& base = scene.levels.front();
  text += "  sources:\n";
  for (const std::size_t i : order) {
    text += fmt::format("    - {{sha256: {}, points: {}}}\n", scene.sources[i].sha256, scene.sources[i].points);
  }
  text += "  levels:\n";
  for (const Lattice& level : scene.levels) {
    text += fmt::format("    - {{nx: {}, ny: {}, spacing_m: {}}}\n", level.nx, level.ny, level.spacing_m);
  }
  text += fmt::format("  layers: [{}]\n", fmt::join(layer_names(scene), ", "));
  if (scene.check_map) {
    const CheckMap& map = *scene.check_map;
    const Lattice& lattice = map.lattice;
    text +=
        fmt::format("  check: {{nx: {}, ny: {}, spacing_m: {}, origin_m: {}, high_m: {}}}\n", lattice.nx, lattice.ny,
                    lattice.spacing_m, numbers({lattice.origin_m.x(), lattice.origin_m.y()}), map.high_m);
  }
  if (scene.charts) {
    const Eigen::Vector3d& origin_m = scene.charts->origin_m;
    text += fmt::format("  charts: {{sheets: {}, nodes: {}, spacing_m: {}, origin_m: {}}}\n",
                        scene.charts->sheets.size(), scene.charts->measured_nodes(), scene.charts->spacing_m,
                        numbers({origin_m.x(), origin_m.y(), origin_m.z()}));
  }
  text += fmt::format("  noise_m: {}\n  height_range_m: {}\n  friction_c_m: {}\n", scene.noise_m,
                      numbers({scene.height_min_m, scene.height_max_m}), scene.friction_c_m);
  text += "origin_m: " + numbers({base.origin_m.x(), base.origin_m.y(), base.origin_m.z()}) + "\n";
  text += "scan_from_grid:\n";
  for (int row = 0; row < 4; ++row) {
    const auto r = scene.scan_from_grid.row(row);
    text += "  - " + numbers({r(0), r(1), r(2), r(3)}) + "\n";
  }
  return text;
}

Eigen::Matrix4d parse_matrix(const yaml::Node& node) {
  if (!node.is_sequence() || node.items.size() != 4) {
    throw yaml::error_at(node, "scan_from_grid is not a 4x4 matrix", "four rows of four numbers");
  }
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    const std::vector<double> values = yaml::to_doubles(node.items[static_cast<std::size_t>(row)], 4);
    for (int column = 0; column < 4; ++column) matrix(row, column) = values[static_cast<std::size_t>(column)];
  }
  return matrix;
}

void require_version(yaml::MapReader& reader) {
  int version = 0;
  const yaml::Node& node = reader.required("version");
  reader.read("version", version, 0, 1 << 30);
  if (version > kFormatVersion) {
    throw yaml::error_at(
        node, fmt::format("scene format {}, which a newer version of sparsha wrote", version),
        fmt::format("at most format {}; a newer version opens it, or build the scene again", kFormatVersion));
  }
  if (version != kFormatVersion) {
    throw yaml::error_at(node, fmt::format("scene format {}", version),
                         fmt::format("format {}; build the scene again", kFormatVersion));
  }
}

void parse_sources(const yaml::Node& sources, SceneDescription& scene) {
  for (const yaml::Node& item : sources.items) {
    yaml::MapReader keys(item, "a source");
    ScanSource source;
    source.sha256 = yaml::to_text(keys.required("sha256"));
    source.points = static_cast<std::uint64_t>(std::max<std::int64_t>(0, yaml::to_integer(keys.required("points"))));
    keys.finish();
    const std::size_t index = scene.sources.size();
    if (index < scene.config.scans.size()) source.file = scene.config.scans[index].file;
    scene.sources.push_back(std::move(source));
  }
}

void parse_levels(const yaml::Node& levels, const std::vector<double>& origin, SceneDescription& scene) {
  for (const yaml::Node& item : levels.items) {
    yaml::MapReader keys(item, "a level");
    Lattice level;
    level.origin_m = {origin[0], origin[1], origin[2]};
    static_cast<void>(keys.required("nx"));
    static_cast<void>(keys.required("ny"));
    static_cast<void>(keys.required("spacing_m"));
    keys.read("nx", level.nx, 1, 1 << 24);
    keys.read("ny", level.ny, 1, 1 << 24);
    keys.read("spacing_m", level.spacing_m, 1e-15, 1e12);
    keys.finish();
    scene.levels.push_back(level);
  }
}

void parse_layers(const yaml::Node& layers, SceneDescription& scene) {
  for (const yaml::Node& item : layers.items) {
    const std::string name = yaml::to_text(item);
    if (name == "height" || name == "mask") continue;
    bool known = name == "colour";
    if (known) scene.has_colour = true;
    for (const OptionalLayer& layer : kFloatLayers) {
      if (name != layer.name) continue;
      scene.*(layer.present) = true;
      known = true;
    }
    if (!known) throw yaml::error_at(item, "unknown layer '" + name + "'", "a scene of this version");
  }
}

// The map's layer is small, and read at once.
std::shared_ptr<const CheckMap> parse_check(const yaml::Node& node, double z_m, const fs::path& folder) {
  yaml::MapReader keys(node, "check");
  auto map = std::make_shared<CheckMap>();
  for (const char* key : {"nx", "ny", "spacing_m", "origin_m", "high_m"}) static_cast<void>(keys.required(key));
  keys.read("nx", map->lattice.nx, 1, CheckMap::kMostNodes);
  keys.read("ny", map->lattice.ny, 1, CheckMap::kMostNodes);
  keys.read("spacing_m", map->lattice.spacing_m, 1e-15, 1e12);
  std::array<double, 2> origin_m{};
  keys.read("origin_m", origin_m);
  map->lattice.origin_m = {origin_m[0], origin_m[1], z_m};
  keys.read("high_m", map->high_m, 0.0, 1e12);
  keys.finish();
  map->error_m.assign(map->lattice.count(), kUnknownHeight);
  const LayerRegion all{map->lattice.nx, map->lattice.ny, 0, 0, map->lattice.nx, map->lattice.ny};
  read_layer(folder / kErrorLayer, all, std::span<float>(map->error_m));
  return map;
}

// Read at once: all of an object's nodes are some 15 bytes a point of its scans.
std::shared_ptr<const Charts> parse_charts(const yaml::Node& node, const fs::path& folder) {
  yaml::MapReader keys(node, "charts");
  auto charts = std::make_shared<Charts>();
  const std::int64_t sheets = yaml::to_integer(keys.required("sheets"));
  const std::int64_t nodes = yaml::to_integer(keys.required("nodes"));
  std::array<double, 3> origin_m{};
  for (const char* key : {"spacing_m", "origin_m"}) static_cast<void>(keys.required(key));
  keys.read("spacing_m", charts->spacing_m, 1e-15, 1e12);
  keys.read("origin_m", origin_m);
  keys.finish();
  charts->origin_m = {origin_m[0], origin_m[1], origin_m[2]};
  charts->sheets = read_sheets(folder / kChartsFile);
  if (charts->sheets.size() != static_cast<std::uint64_t>(sheets) ||
      charts->measured_nodes() != static_cast<std::uint64_t>(nodes)) {
    throw input_error((folder / kChartsFile).string(), "there are other sheets in it than scene.yaml says",
                      fmt::format("{} sheets with {} nodes", sheets, nodes));
  }
  return charts;
}

SceneDescription parse_scene(const fs::path& folder) {
  const fs::path file = folder / "scene.yaml";
  yaml::Node root = yaml::parse_file(file);
  if (!root.is_map()) throw yaml::error_at(root, "this is not a scene", "a scene.yaml written by sparsha build");
  const auto take = [&](std::string_view key) {
    const auto found = std::find_if(root.entries.begin(), root.entries.end(),
                                    [&](const yaml::Entry& entry) { return entry.key == key; });
    if (found == root.entries.end()) {
      throw yaml::error_at(root, fmt::format("no '{}'", key), "a scene.yaml written by sparsha build");
    }
    yaml::Node node = std::move(found->value);
    root.entries.erase(found);
    return node;
  };
  const yaml::Node scene_node = take("scene");
  const yaml::Node origin_node = take("origin_m");
  const yaml::Node matrix_node = take("scan_from_grid");

  SceneDescription scene;
  scene.config = parse_config(root, folder);
  const std::vector<double> origin = yaml::to_doubles(origin_node, 3);
  scene.scan_from_grid = parse_matrix(matrix_node);
  if (const auto& regions = scene.config.orientation.regions_scan_to_grid) {
    scene.region_from_grid = *regions * scene.scan_from_grid;
  }
  yaml::MapReader reader(scene_node, "scene");
  require_version(reader);
  parse_sources(reader.required("sources"), scene);
  parse_levels(reader.required("levels"), origin, scene);
  if (scene.levels.empty()) throw yaml::error_at(scene_node, "the scene has no levels", "at least one");
  if (!has_cell(scene.levels.front())) {
    throw yaml::error_at(
        scene_node,
        fmt::format("a grid of {} x {} nodes has no cell", scene.levels.front().nx, scene.levels.front().ny),
        "at least 2 x 2 nodes on the first level");
  }
  parse_layers(reader.required("layers"), scene);
  if (const yaml::Node* check = reader.optional("check")) scene.check_map = parse_check(*check, origin[2], folder);
  if (const yaml::Node* charts = reader.optional("charts")) scene.charts = parse_charts(*charts, folder);
  reader.read("noise_m", scene.noise_m, 0.0, 1e12);
  reader.read("friction_c_m", scene.friction_c_m, 0.0, 1e12);
  const std::vector<double> range = yaml::to_doubles(reader.required("height_range_m"), 2);
  scene.height_min_m = range[0];
  scene.height_max_m = range[1];
  reader.finish();
  return scene;
}

// That each layer of a level is there and is what scene.yaml says.
void check_layers(const fs::path& path, const SceneDescription& scene, const Lattice& lattice) {
  for (const std::string& name : layer_names(scene)) {
    const LayerKind kind = name == "mask" ? LayerKind::byte : name == "colour" ? LayerKind::rgba : LayerKind::number;
    check_layer(path / (name + ".tif"), lattice.nx, lattice.ny, kind);
  }
}

class FolderScene final : public Scene {
 public:
  FolderScene(fs::path folder, SceneDescription description)
      : folder_(std::move(folder)),
        description_(std::move(description)),
        opened_(heights_written(folder_)),
        told_(told_in(folder_)) {}

  [[nodiscard]] const SceneDescription& description() const override { return description_; }
  [[nodiscard]] fs::path folder() const override { return folder_; }

  [[nodiscard]] Layers read(int level, int i0, int j0, int nx, int ny) const override {
    const Lattice& lattice = description_.levels.at(static_cast<std::size_t>(level));
    const fs::path path = level_folder(folder_, static_cast<std::size_t>(level));
    const LayerRegion region{lattice.nx, lattice.ny, i0, j0, nx, ny};
    check_layers(path, description_, lattice);  // before memory is taken for them
    Layers layers;
    layers.grid = DepthGrid(window_lattice(lattice, i0, j0, nx, ny));
    const std::size_t count = layers.grid.lattice.count();
    read_heights(path, region, description_, layers);
    for (const OptionalLayer& layer : kFloatLayers) {
      if (!(description_.*(layer.present))) continue;
      std::vector<float>& values = layers.*(layer.values);
      const bool heights = layer.values == &Layers::envelope_m || layer.values == &Layers::intensity;
      values.assign(count, heights ? kUnknownHeight : 0.0F);
      read_layer(path / fmt::format("{}.tif", layer.name), region, std::span<float>(values));
    }
    if (description_.has_colour) {
      layers.colour_rgba.assign(count, 0);
      read_layer(path / "colour.tif", region, std::span<std::uint32_t>(layers.colour_rgba));
    }
    require_same_folder();
    return layers;
  }

 private:
  /// When the heights were written, which a scene's folder says for as long as nothing else takes its place.
  static fs::file_time_type heights_written(const fs::path& folder) {
    std::error_code code;
    return fs::last_write_time(level_folder(folder, 0) / "height.tif", code);
  }
  static std::string told_in(const fs::path& folder) {
    constexpr std::size_t kMostTold = 1U << 24U;
    try {
      return read_file(folder / "scene.yaml", kMostTold);
    } catch (const Error&) {
      return {};
    }
  }
  /// What was read of another scene would not fit what is known of this one.
  void require_same_folder() const {
    const fs::file_time_type now = heights_written(folder_);
    if (now == opened_ || now == fs::file_time_type::min()) return;  // what is missing is told by its name
    if (told_in(folder_) == told_) return;                           // touched, or copied to the same place
    throw input_error(folder_.string(), "another scene has taken the place of the one that was opened",
                      "the scene opened again");
  }

  fs::path folder_;
  SceneDescription description_;
  fs::file_time_type opened_;
  std::string told_;  // by its scene.yaml
};

template <typename Written>
void write_level(const Layers& layers, const SceneDescription& scene, const fs::path& folder, const Written& written) {
  fs::create_directories(folder);
  const Lattice& lattice = layers.grid.lattice;
  const int nx = lattice.nx;
  const int ny = lattice.ny;
  write_layer(folder / "height.tif", nx, ny, std::span<const float>(layers.grid.height_m));
  written();
  write_file(folder / "height.tfw", world_file(lattice, scene));
  write_file(folder / kVrtFile, vrt_file(lattice, scene, layer_names(scene)));
  static_assert(sizeof(NodeState) == 1, "a mask is the states' bytes");
  const auto* mask = reinterpret_cast<const std::uint8_t*>(layers.grid.state.data());
  write_layer(folder / "mask.tif", nx, ny, std::span<const std::uint8_t>(mask, lattice.count()));
  written();
  for (const OptionalLayer& layer : kFloatLayers) {
    if (!(scene.*(layer.present))) continue;
    write_layer(folder / fmt::format("{}.tif", layer.name), nx, ny, std::span<const float>(layers.*(layer.values)));
    written();
  }
  if (!scene.has_colour) return;
  write_layer(folder / "colour.tif", nx, ny, std::span<const std::uint32_t>(layers.colour_rgba));
  written();
}

}  // namespace

ScenePointer open_scene(const fs::path& folder, Trust trust) {
  std::error_code code;
  if (!fs::is_regular_file(folder / "scene.yaml", code)) {
    throw input_error(folder.string(), "there is no scene.yaml in it", "a scene folder written by sparsha build");
  }
  const auto require_inside = [&](const fs::path& file, const char* what) {
    if (trust == Trust::any_file || lies_within(file, folder)) return;
    throw input_error(file.string(), std::string(what) + " lies outside the scene's folder",
                      "a scene that holds all it needs; --trust, if you know where it comes from");
  };
  const auto is_link = [&](const fs::path& file) { return fs::is_symlink(fs::symlink_status(file, code)); };
  if (is_link(folder / "scene.yaml")) require_inside(folder / "scene.yaml", "the description");
  for (const char* name : {kErrorLayer, kChartsFile})
    if (is_link(folder / name)) require_inside(folder / name, "the layer");
  SceneDescription description;
  try {
    description = parse_scene(folder);
  } catch (const Error& error) {  // a damaged scene is bad input, not bad usage
    throw Error(ErrorKind::input, error.place(), error.wrong(), error.expected());
  }
  if (description.config.audio) {
    for (const AudioRegionConfig& region : description.config.audio->regions) {
      if (const auto* clip = std::get_if<fs::path>(&region.sound)) require_inside(*clip, "the clip");
    }
    if (description.config.audio->labels) require_inside(description.config.audio->labels->file, "the label image");
  }
  for (std::size_t level = 0; level < description.levels.size(); ++level) {
    const fs::path path = level_folder(folder, level);
    const bool linked = is_link(path);
    for (const std::string& name : layer_names(description)) {
      const fs::path layer = path / (name + ".tif");
      if (linked || is_link(layer)) require_inside(layer, "the layer");
    }
    check_layers(path, description, description.levels[level]);
  }
  make_areas(description);
  return std::make_shared<FolderScene>(folder, std::move(description));
}

void write_scene(const Scene& scene, const fs::path& folder) {
  Progress unheard;
  write_scene(scene, folder, unheard);
}

void write_scene(const Scene& scene, const fs::path& folder, Progress& progress) {
  const SceneDescription& description = scene.description();
  const std::size_t layers_a_level = layer_names(description).size();
  double all = 0.0;
  for (const Lattice& level : description.levels) all += static_cast<double>(level.count());
  double written = 0.0;
  for (std::size_t level = 0; level < description.levels.size(); ++level) {
    const double nodes = static_cast<double>(description.levels[level].count()) / static_cast<double>(layers_a_level);
    const auto look = [&] { progress.at(std::min(1.0, written / all)); };
    const auto layer_written = [&] {
      written += nodes;
      look();
    };
    look();
    const auto l = static_cast<int>(level);
    if (const Layers* layers = scene.in_memory(l)) {
      write_level(*layers, description, level_folder(folder, level), layer_written);
    } else {
      write_level(scene.read_level(l), description, level_folder(folder, level), layer_written);
    }
  }
  if (const auto& map = description.check_map)
    write_layer(folder / kErrorLayer, map->lattice.nx, map->lattice.ny, std::span<const float>(map->error_m));
  if (description.charts) write_sheets(folder / kChartsFile, description.charts->sheets);
  write_file(folder / "scene.yaml", scene_yaml(description, folder));
}

std::vector<fs::path> layer_files(const SceneDescription& scene) {
  std::vector<fs::path> files;
  for (std::size_t level = 0; level < scene.levels.size(); ++level) {
    const fs::path folder = level_folder({}, level);
    for (const std::string& name : layer_names(scene)) files.push_back(folder / (name + ".tif"));
    files.push_back(folder / "height.tfw");
    files.push_back(folder / kVrtFile);
  }
  if (scene.check_map) files.emplace_back(kErrorLayer);
  if (scene.charts) files.emplace_back(kChartsFile);
  return files;
}

void write_description(const Scene& scene, const fs::path& folder) {
  write_file(folder / "scene.yaml", scene_yaml(scene.description(), folder));
}

}  // namespace sparsha::scene
