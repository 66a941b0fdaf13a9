// The simulation's YAML (docs/measure/simulation.md).
#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/simulate.h"
#include "pipeline/simulate/statue.h"

namespace sparsha::pipeline {
namespace {

using yaml::MapReader;
using yaml::Node;

constexpr double kMilli = 1e-3;
constexpr double kMaxSize_m = 1e5;
constexpr double kFarthest =
    1e9;  // of a station, metres: beyond it double precision does not tell the surface's points
constexpr std::size_t kMostStations = 1000;

/// A length given in millimetres.
void read_mm(MapReader& reader, std::string_view key, double& metres, double low_m, double high_m) {
  double mm = metres / kMilli;
  if (reader.optional(key) == nullptr) return;
  reader.read(key, mm, low_m / kMilli, high_m / kMilli);
  metres = mm * kMilli;
}

void read_vector(MapReader& reader, std::string_view key, Eigen::Vector3d& vector) {
  std::array<double, 3> values{vector.x(), vector.y(), vector.z()};
  reader.read(key, values);
  vector = {values[0], values[1], values[2]};
}

void read_seed(MapReader& reader, std::uint64_t& seed) {
  if (const Node* node = reader.optional("seed")) {
    const std::int64_t value = yaml::to_integer(*node);
    if (value < 0) throw yaml::error_at(*node, "a negative seed", "expected an integer from 0");
    seed = static_cast<std::uint64_t>(value);
  }
}

BackConfig parse_back(const Node& node) {
  MapReader reader(node, "back");
  BackConfig back;
  int kind = 0;
  reader.required("kind");
  reader.read_choice("kind", kind, {"rough", "parallel"});
  back.kind = kind == 0 ? BackConfig::Kind::rough : BackConfig::Kind::parallel;
  read_mm(reader, "depth_mm", back.depth_m, 1e-6, kMaxSize_m);
  if (back.kind == BackConfig::Kind::rough) read_mm(reader, "roughness_mm", back.roughness_m, 0.0, kMaxSize_m);
  reader.read("density", back.density, 0.0, 100.0);
  reader.finish();
  return back;
}

/// Reads the keys of the chosen form.
struct FormReader {
  MapReader& reader;

  void operator()(PlaneForm& f) const {
    std::array<double, 2> slope{f.slope_x, f.slope_y};
    reader.read("slope", slope);
    f = {slope[0], slope[1]};
  }
  void operator()(SinusoidForm& f) const {
    read_mm(reader, "amplitude_mm", f.amplitude_m, 0.0, kMaxSize_m);
    read_mm(reader, "wavelength_mm", f.wavelength_m, 1e-6, kMaxSize_m);
  }
  void operator()(AccuracyForm& f) const {
    read_mm(reader, "step_mm", f.step_m, 0.0, kMaxSize_m);
    read_mm(reader, "groove_mm", f.groove_m, 0.0, kMaxSize_m);
    read_mm(reader, "groove_width_mm", f.groove_width_m, 1e-6, kMaxSize_m);
  }
  void operator()(BarsForm& f) const {
    read_mm(reader, "bar_mm", f.bar_m, 0.0, kMaxSize_m);
    read_mm(reader, "width_mm", f.width_m, 1e-6, kMaxSize_m);
    read_mm(reader, "pitch_mm", f.pitch_m, 1e-6, kMaxSize_m);
    reader.read("slanted", f.slanted);
  }
  void operator()(ReliefForm& f) const {
    read_seed(reader, f.seed);
    read_mm(reader, "grain_mm", f.grain_m, 0.0, 0.01);
    reader.read("inscription", f.inscription);
  }
  void operator()(FacadeForm& f) const { read_mm(reader, "window_mm", f.window_m, 0.0, 1.0); }
  void operator()(HallForm& f) const {
    reader.read("minor", f.minor, 0, 1000);
    read_mm(reader, "major_mm", f.major_m, 1e-6, kMaxSize_m);
    read_mm(reader, "minor_mm", f.minor_m, 1e-6, kMaxSize_m);
    read_mm(reader, "gap_mm", f.gap_m, 0.0, kMaxSize_m);
    read_mm(reader, "grain_mm", f.grain_m, 0.0, 0.01);
  }
  void operator()(StatueForm&) const {}
};

SurfaceConfig parse_surface(const Node& node) {
  MapReader reader(node, "surface");
  SurfaceConfig surface;
  int form = 0;
  reader.required("form");
  reader.read_choice("form", form, {"plane", "sinusoid", "accuracy", "bars", "relief", "facade", "hall", "statue"});
  const std::array<Form, 8> forms{PlaneForm{},  SinusoidForm{}, AccuracyForm{}, BarsForm{},
                                  ReliefForm{}, FacadeForm{},   HallForm{},     StatueForm{}};
  const std::array<std::array<double, 2>, 8> sizes{
      {{1, 1}, {1, 1}, {1, 1}, {1, 1}, {0.36, 0.44}, {8, 5}, {4.0, 2.4}, {kStatueWidth_m, kStatueHeight_m}}};
  surface.form = forms[static_cast<std::size_t>(form)];
  std::array<double, 2> size = sizes[static_cast<std::size_t>(form)];
  reader.read("size_m", size);
  if (!(std::min(size[0], size[1]) > 0.0) || std::max(size[0], size[1]) > kMaxSize_m) {
    throw yaml::error_at(*node.find("size_m"), "an impossible size", "expected two numbers above 0, metres");
  }
  surface.width_m = size[0];
  surface.height_m = size[1];
  std::visit(FormReader{reader}, surface.form);
  if (const Node* back = reader.optional("back")) surface.back = parse_back(*back);
  reader.finish();
  return surface;
}

SamplerConfig parse_sampler(const Node& node) {
  MapReader reader(node, "sampler");
  SamplerConfig sampler;
  reader.read("points_per_node", sampler.points_per_node, 1e-6, 1e6);
  reader.read("density_ratio", sampler.density_ratio, 1e-6, 1e6);
  reader.read("files", sampler.files, 1, 1000);
  reader.finish();
  return sampler;
}

ScannerConfig parse_stations(const Node& node) {
  if (!node.is_sequence() || node.items.empty()) {
    throw yaml::error_at(node, "stations is not a list", "expected at least one `- {position_m: [x, y, z], ...}`");
  }
  if (node.items.size() > kMostStations) {
    throw yaml::error_at(node, std::to_string(node.items.size()) + " stations", "expected at most 1000");
  }
  ScannerConfig scanner;
  std::set<std::string> names;
  for (const Node& item : node.items) {
    MapReader reader(item, "stations");
    StationConfig station;
    station.name = "station-" + std::to_string(scanner.stations.size() + 1);
    reader.read("name", station.name);
    const bool clean = !station.name.empty() && station.name.find_first_of("/\\\"'\n") == std::string::npos;
    if (!clean || !names.insert(station.name).second) {
      throw yaml::error_at(item, "two stations of one name, or a name that no file can have", "expected plain names");
    }
    reader.required("position_m");
    reader.required("target_m");
    read_vector(reader, "position_m", station.position_m);
    read_vector(reader, "target_m", station.target_m);
    for (const char* key : {"position_m", "target_m"}) {
      const Eigen::Vector3d& place = key[0] == 'p' ? station.position_m : station.target_m;
      if (place.cwiseAbs().maxCoeff() > kFarthest) {
        throw yaml::error_at(*item.find(key), "a place more than 1e9 m away", "expected metres");
      }
    }
    double step_mrad = station.step_rad / kMilli;
    reader.read("step_mrad", step_mrad, 1e-4, 100.0);
    station.step_rad = step_mrad * kMilli;
    reader.finish();
    try {
      (void)local_from_station_rotation(station);
    } catch (const Error& error) {
      throw yaml::error_at(item, error.wrong(), error.expected());
    }
    scanner.stations.push_back(station);
  }
  return scanner;
}

void parse_output(const Node& node, SimulationConfig& config) {
  MapReader reader(node, "output");
  int choice = config.double_precision ? 1 : 0;
  reader.read_choice("coordinates", choice, {"float", "double"});
  config.double_precision = choice == 1;
  reader.read("intensity", config.intensity);
  reader.read("colour", config.colour);
  choice = 0;
  reader.read_choice("frame", choice, {"scan", "station"});
  config.station_frame = choice == 1;
  if (config.station_frame && !std::holds_alternative<ScannerConfig>(config.scan)) {
    throw yaml::error_at(*node.find("frame"), "a sampler has no stations", "expected frame: scan");
  }
  reader.read("truth", config.write_truth);
  reader.finish();
}

}  // namespace

SimulationConfig parse_simulation(const Node& root) {
  MapReader reader(root, "the simulation");
  SimulationConfig config;
  read_seed(reader, config.seed);
  config.surface = parse_surface(reader.required("surface"));
  const Node* stations = reader.optional("stations");
  const Node* sampler = reader.optional("sampler");
  if ((stations == nullptr) == (sampler == nullptr)) {
    throw yaml::error_at(stations == nullptr ? root : *stations, "there must be one way to scan",
                         "expected either `stations` or `sampler`");
  }
  if (sampler != nullptr && std::holds_alternative<StatueForm>(config.surface.form)) {
    throw yaml::error_at(*sampler, "a statue is seen from all sides", "expected `stations` about it");
  }
  if (stations != nullptr) {
    config.scan = parse_stations(*stations);
  } else {
    config.scan = parse_sampler(*sampler);
  }
  reader.read("nodes", config.nodes, 2, 1 << 16);
  read_mm(reader, "noise_mm", config.noise_m, 0.0, 1.0);
  if (const Node* node = reader.optional("outliers")) {
    MapReader outliers(*node, "outliers");
    config.outlier_fraction = 0.005;
    outliers.read("fraction", config.outlier_fraction, 0.0, 1.0);
    read_mm(outliers, "spread_mm", config.outlier_spread_m, 0.0, kMaxSize_m);
    outliers.finish();
  }
  if (const Node* node = reader.optional("placement")) {
    MapReader placement(*node, "placement");
    read_vector(placement, "origin_m", config.origin_m);
    read_vector(placement, "look_from", config.look_from);
    read_vector(placement, "up", config.up);
    placement.finish();
    try {
      (void)grid_from_scan_rotation(config);
    } catch (const Error& error) {
      throw yaml::error_at(*node, error.wrong(), error.expected());
    }
  }
  if (const Node* node = reader.optional("output")) parse_output(*node, config);
  reader.finish();
  try {
    (void)Surface(config.surface);
  } catch (const Error& error) {
    throw yaml::error_at(*root.find("surface"), error.wrong(), error.expected());
  }
  return config;
}

}  // namespace sparsha::pipeline
