// `sparsha simulate`: files beside each other, each whole or not there.
#include "pipeline/simulate/simulate.h"

#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/base/files.h"
#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/outputs.h"
#include "pipeline/simulate/ply_stream.h"

namespace sparsha::pipeline {
namespace {

std::string file_name(const SimulationConfig& config, std::size_t index) {
  if (const auto* scanner = std::get_if<ScannerConfig>(&config.scan)) return scanner->stations[index].name + ".ply";
  return file_count(config) == 1 ? "scan.ply" : fmt::format("scan-{}.ply", index + 1);
}

SimulatedFile write_scan(const SimulationConfig& config, const Surface& surface, std::size_t index,
                         const std::filesystem::path& temporary, const std::string& shown, ThreadPool& pool,
                         Progress& progress) {
  StationPose frame{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  if (config.station_frame) {
    frame = scan_from_station(config, std::get<ScannerConfig>(config.scan).stations[index]);
  }
  SimulatedFile file;
  file.name = file_name(config, index);
  PlyStream stream(temporary, shown, {config.double_precision, config.intensity, config.colour},
                   fmt::format("simulated scan, seed {}, metres", config.seed));
  generate_file(config, surface, index, pool, progress, [&](std::span<const SimulatedPoint> points) {
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

  std::vector<SimulatedFile> files;
  std::vector<std::unique_ptr<AtomicPath>> written;
  for (std::size_t index = 0; index < file_count(config); ++index) {
    const std::string name = file_name(config, index);
    progress.begin("scan " + name);
    written.push_back(std::make_unique<AtomicPath>(out / name));
    files.push_back(
        write_scan(config, truth.surface(), index, written.back()->temporary(), (out / name).string(), pool, progress));
    if (files.back().points == 0) progress.warn(name + " has no points: the station sees nothing of the surface");
  }
  if (config.write_truth) {
    progress.begin("truth");
    written.push_back(std::make_unique<AtomicPath>(out / "truth.tif"));
    write_truth_tiff(truth, written.back()->temporary(), (out / "truth.tif").string(), pool, progress);
  }
  for (const auto& path : written) path->commit();
  if (config.write_truth) write_file(out / "truth.tfw", truth_world_file(truth));
  write_file(out / "truth.json", truth_json(config, truth, files));
  write_file(out / "sparsha.yaml", build_yaml(config, truth, files));
  progress.finish();
}

void simulate(const std::filesystem::path& config, const std::filesystem::path& out, Progress& progress) {
  write_simulation(parse_simulation(yaml::parse_file(config)), out, progress);
}

}  // namespace sparsha::pipeline
