// `sparsha simulate`: files beside each other, each whole or not there.
#include "pipeline/simulate/simulate.h"

#include <fstream>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files/files.h"
#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/outputs.h"
#include "pipeline/simulate/ply_stream.h"

namespace sparsha::pipeline {
namespace {

std::string file_name(const SimulationConfig& config, std::size_t index) {
  if (const auto* scanner = std::get_if<ScannerConfig>(&config.scan)) return scanner->stations[index].name + ".ply";
  return file_count(config) == 1 ? "scan.ply" : fmt::format("scan-{}.ply", index + 1);
}

constexpr const char* kTruthName = "truth.json";

/// In the order in which they take their places.
std::vector<std::string> output_names(const SimulationConfig& config) {
  std::vector<std::string> names;
  for (std::size_t index = 0; index < file_count(config); ++index) names.push_back(file_name(config, index));
  names.insert(names.end(), {kTruthName, "sparsha.yaml"});
  if (config.write_truth) names.insert(names.end(), {"truth.tfw", "truth.tif"});
  return names;
}

void write_text(const AtomicPath& file, const std::string& text) {
  file.naming_target([&] {
    std::ofstream stream(file.temporary(), std::ios::binary);
    stream << text;
    stream.close();
    if (stream) return;
    throw Error(ErrorKind::failure, {file.temporary().string(), 0, 0}, "cannot be written", "room on the disk");
  });
}

SimulatedFile write_scan(const SimulationConfig& config, const Surface& surface, std::size_t index,
                         const std::filesystem::path& temporary, const std::string& shown, const Context& context) {
  StationPose frame{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  if (config.station_frame) {
    frame = scan_from_station(config, std::get<ScannerConfig>(config.scan).stations[index]);
  }
  SimulatedFile file;
  file.name = file_name(config, index);
  PlyStream stream(temporary, shown, {config.double_precision, config.intensity, config.colour},
                   fmt::format("simulated scan, seed {}, metres", config.seed));
  generate_file(config, surface, index, context, [&](std::span<const SimulatedPoint> points) {
    stream.append(points, frame.rotation, frame.translation_m);
    for (const SimulatedPoint& point : points) {
      file.back += point.is_front ? 0 : 1;
      file.outliers += point.is_outlier ? 1 : 0;
    }
  });
  stream.close();
  file.points = stream.count();
  return file;
}

}  // namespace

void write_simulation(const SimulationConfig& config, const std::filesystem::path& out, Progress& progress) {
  const Truth truth(config);
  ThreadPool pool;
  std::error_code code;
  std::filesystem::create_directories(out, code);
  if (!std::filesystem::is_directory(out, code)) {
    throw Error(ErrorKind::failure, {out.string(), 0, 0}, "is not a folder and cannot be made one",
                "expected a folder that can be written to");
  }

  // Names that nobody chose must not take the place of files that somebody did.
  const bool old_simulation = std::filesystem::exists(out / kTruthName, code);
  for (const std::string& name : output_names(config)) {
    if (old_simulation || !std::filesystem::exists(out / name, code)) continue;
    throw usage_error("the folder " + out.string() + " holds a " + name + " that is of no simulation",
                      "another folder");
  }

  // All are made before the work: a name that cannot be written is told at once.
  std::vector<std::unique_ptr<AtomicPath>> written;
  for (const std::string& name : output_names(config)) written.push_back(std::make_unique<AtomicPath>(out / name));
  const auto temporary = [&](std::size_t index) { return written[index]->temporary(); };

  std::vector<SimulatedFile> files;
  for (std::size_t index = 0; index < file_count(config); ++index) {
    const std::string name = file_name(config, index);
    progress.begin("scan " + name);
    files.push_back(
        write_scan(config, truth.surface(), index, temporary(index), (out / name).string(), {pool, progress}));
    if (files.back().points == 0) progress.warn(name + " has no points: the station sees nothing of the surface");
  }
  std::size_t next = files.size();
  write_text(*written[next++], truth_json(config, truth, files));
  write_text(*written[next++], build_yaml(config, truth, files));
  if (config.write_truth) {
    progress.begin("truth");
    write_text(*written[next++], truth_world_file(truth));
    write_truth_tiff(truth, temporary(next), (out / "truth.tif").string(), {pool, progress});
  }
  progress.throw_if_cancelled();
  for (const auto& path : written) path->commit();
  progress.finish();
}

void simulate(const std::filesystem::path& config, const std::filesystem::path& out, Progress& progress) {
  const SimulationConfig simulation = parse_simulation(yaml::parse_file(config));
  for (const std::string& name : output_names(simulation))
    require_distinct({{"--out", out / name}}, {{"the configuration", config}});
  write_simulation(simulation, out, progress);
}

}  // namespace sparsha::pipeline
