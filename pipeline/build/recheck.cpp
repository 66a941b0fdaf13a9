// Points are classified by projecting them on the scene's own lattice; heights are the scene's.
#include "pipeline/build/recheck.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/files.h"
#include "base/thread_pool.h"
#include "pipeline/check/check.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/repeated.h"
#include "scene/scene_folder.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

std::vector<ScanConfig> scans_to_check(const SceneDescription& scene, const std::vector<fs::path>& files) {
  if (files.empty()) {
    std::error_code code;
    for (const ScanConfig& scan : scene.config.scans) {
      if (!fs::is_regular_file(scan.file, code)) {
        throw input_error(scan.file.string(), "the scan this scene was made from is not there any more",
                          "name the scans to check against");
      }
    }
    return scene.config.scans;
  }
  std::vector<ScanConfig> scans;
  for (const fs::path& file : files) {
    ScanConfig scan;
    scan.file = file;
    const MappedFile mapped(file);
    const std::string digest = mapped.whole([&] { return sha256(mapped.bytes()); });
    for (std::size_t i = 0; i < std::min(scene.sources.size(), scene.config.scans.size()); ++i) {
      if (scene.sources[i].sha256 != digest) continue;
      scan.units = scene.config.scans[i].units;
      scan.pose = scene.config.scans[i].pose;
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

// A file that is no scan may hold what is nobody's business: what a message quotes of it is left out.
std::string without_quotes(const std::string& message) {
  std::string text;
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t open = message.find('\'', at);
    const std::size_t close = open == std::string::npos ? open : message.rfind('\'');
    if (open == std::string::npos || close == open) return text + message.substr(at);
    text += message.substr(at, open - at) + "'...'";
    at = close + 1;
  }
  return text;
}

Cloud load_quietly(const std::vector<ScanConfig>& scans, Progress& progress) {
  try {
    return load_scans(without_repeats(scans, progress), progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    throw Error(error.kind(), error.place(), without_quotes(error.wrong()), error.expected());
  }
}

}  // namespace

Report recheck_scene(const Scene& scene, const std::vector<fs::path>& scans, const CheckConfig& check, unsigned threads,
                     Progress& progress, Trust trust) {
  const SceneDescription& description = scene.description();
  if (scans.empty() && !scene.folder().empty() && trust == Trust::own_folder) {
    require_own_scans(description, scene.folder());
  }
  ThreadPool pool(threads);
  Report report;
  progress.begin("read");
  const Cloud cloud = load_quietly(scans_to_check(description, scans), progress);
  report.points.read = cloud.size() + cloud.invalid;
  report.points.invalid = cloud.invalid;

  progress.begin("project");
  const Lattice& base = description.levels.front();
  GridConfig grid;
  grid.spacing_m = base.spacing_m;
  grid.bounds_m = {base.x_m(0), base.y_m(0), base.x_m(base.nx - 1), base.y_m(base.ny - 1)};
  const Eigen::Matrix4d scan_to_grid = description.scan_from_grid.inverse();
  Projection projection = project(cloud, scan_to_grid, grid, description.config.haptics.resolution_m, {pool, progress});
  report.points.used = projection.used;
  report.points.occluded = projection.occluded;
  report.points.outlier = projection.outlier;
  report.points.outside = projection.outside;

  progress.begin("cross-check");
  projection.grid = scene.read_level(0).grid;
  projection.noise_m = std::max(projection.noise_m, description.noise_m);
  report.check = cross_check(cloud, scan_to_grid, projection, description.config.fill, check, {pool, progress});
  progress.finish();
  const auto count = [&](NodeState state) {
    return static_cast<double>(std::count(projection.grid.state.begin(), projection.grid.state.end(), state)) /
           static_cast<double>(projection.grid.state.size());
  };
  report.coverage = count(NodeState::measured);
  report.filled_fraction = count(NodeState::filled);
  report.stages = progress.stages();
  report.warnings = progress.warnings();
  return report;
}

}  // namespace sparsha::pipeline
