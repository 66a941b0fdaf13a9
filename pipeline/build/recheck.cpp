// Points are filtered and classified as by a build on the scene's own lattice; heights are the scene's.
#include "pipeline/build/recheck.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"
#include "base/threads/thread_pool.h"
#include "pipeline/build/project_scans.h"
#include "pipeline/build/warnings.h"
#include "pipeline/scan/repeated.h"
#include "scene/folder/folder.h"
#include "scene/folder/heights.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

struct ScansToCheck {
  std::vector<scene::ScanConfig> scans;
  bool own = true;  ///< the scene was made from all of them
};

ScansToCheck scans_to_check(const scene::SceneDescription& scene, const std::vector<fs::path>& files) {
  if (files.empty()) {
    std::error_code code;
    for (const scene::ScanConfig& scan : scene.config.scans) {
      if (!fs::is_regular_file(scan.file, code)) {
        throw input_error(scan.file.string(), "the scan this scene was made from is not there any more",
                          "name the scans to check against");
      }
    }
    return {scene.config.scans};
  }
  ScansToCheck result;
  for (const fs::path& file : files) {
    scene::ScanConfig scan;
    scan.file = file;
    const MappedFile mapped(file);
    const std::string digest = mapped.whole([&] { return sha256(mapped.bytes()); });
    bool own = false;
    for (std::size_t i = 0; i < std::min(scene.sources.size(), scene.config.scans.size()); ++i) {
      if (scene.sources[i].sha256 != digest) continue;
      scan.units = scene.config.scans[i].units;
      scan.pose = scene.config.scans[i].pose;
      scan.columns = scene.config.scans[i].columns;
      own = true;
    }
    result.own = result.own && own;
    result.scans.push_back(std::move(scan));
  }
  return result;
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

// What is said of a scan quotes nothing of it; what is said of the scene's filters stays. The grid is the scene's, and
// no setting of it helps.
ProjectedScans project_quietly(scene::Config& config, const Context& context) {
  try {
    config.scans = without_repeats(config.scans, context.progress);
    return project_scans(config, {}, context);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    if (error.place().file.empty() && error.kind() == ErrorKind::input) {
      throw input_error(config.scans.front().file.string(), without_quotes(error.wrong()),
                        "scans of the surface that the scene shows, in the scene's coordinates");
    }
    const auto is_place = [&](const scene::ScanConfig& scan) { return scan.file.string() == error.place().file; };
    if (!error.place().file.empty() && std::ranges::none_of(config.scans, is_place)) throw;
    throw Error(error.kind(), error.place(), without_quotes(error.wrong()), error.expected());
  }
}

// The build of the scene up to its cross-check, on the lattice that it has; `scans` in place of its own.
scene::Config config_of_check(const scene::SceneDescription& scene, ScansToCheck&& scans,
                              const scene::CheckConfig& check) {
  scene::Config config;
  config.scans = std::move(scans.scans);
  if (scans.own) {
    config.filters = scene.config.filters;
    config.grid.noise_m = scene.config.grid.noise_m;
  }
  config.orientation.scan_to_grid = scene.config.orientation.scan_to_grid;
  config.unroll = scene.config.unroll;
  const scene::Lattice& base = scene.levels.front();
  config.grid.spacing_m = base.spacing_m;
  config.grid.bounds_m = {base.x_m(0), base.y_m(0), base.x_m(base.nx - 1), base.y_m(base.ny - 1)};
  config.grid.colour = config.grid.intensity = false;
  config.haptics.resolution_m = scene.config.haptics.resolution_m;
  config.fill = scene.config.fill;
  config.check = check;
  return config;
}

}  // namespace

Report recheck_scene(const scene::Scene& scene, const std::vector<fs::path>& scans, const scene::CheckConfig& check,
                     unsigned threads, Progress& progress, scene::Trust trust) {
  const scene::SceneDescription& description = scene.description();
  if (scans.empty() && !scene.folder().empty() && trust == scene::Trust::own_folder) {
    scene::require_own_scans(description, scene.folder());
  }
  ThreadPool pool(threads);
  scene::Config config = config_of_check(description, scans_to_check(description, scans), check);
  ProjectedScans projected = project_quietly(config, {pool, progress});
  Report report = take_counts(projected);

  if (description.charts && projected.check_charts) {
    progress.begin("cross-check of charts");
    const scene::Charts& charts = *description.charts;
    report.around = AroundReport{};
    report.around->sheets = charts.sheets.size();
    report.around->nodes = charts.measured_nodes();
    report.around->spacing_m = charts.spacing_m;
    report.around->check = projected.check_charts(charts);
    if (const auto doubt = doubt_of_sides(report.around->check->sides)) progress.warn(*doubt);
  }
  progress.begin("cross-check");
  scene::Layers layers = scene.read_level(0);
  if (const std::string doubt = scene::doubt_of_heights(layers, 0); !doubt.empty()) progress.warn(doubt);
  scene::DepthGrid& grid = layers.grid;
  report.check = projected.check(grid);
  progress.finish();
  const auto count = [&](scene::NodeState state) {
    return static_cast<double>(std::count(grid.state.begin(), grid.state.end(), state)) /
           static_cast<double>(grid.state.size());
  };
  report.coverage = count(scene::NodeState::measured);
  report.filled_fraction = count(scene::NodeState::filled);
  report.stages = progress.stages();
  report.warnings = progress.warnings();
  return report;
}

}  // namespace sparsha::pipeline
