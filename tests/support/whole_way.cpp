#include "tests/support/whole_way.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/threads/thread_pool.h"
#include "haptics/replay/trace.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/surface.h"
#include "haptics/window/window.h"
#include "pipeline/build/build.h"
#include "pipeline/build/recheck.h"
#include "pipeline/export/export.h"
#include "pipeline/replica/replica.h"
#include "pipeline/report/report.h"
#include "pipeline/scan/reader.h"
#include "pipeline/suggest/suggest.h"
#include "scene/ground/window_lattice.h"
#include "scene/scene.h"

namespace sparsha::test {
namespace {
namespace fs = std::filesystem;

using scene::DepthGrid;
using scene::Layers;
using scene::NodeState;

void require(bool holds, const std::string& what) {
  if (!holds) throw Broken(what);
}

// Nothing on the way behind a build may fail.
template <typename Step>
auto must(const std::string& what, const Step& step) {
  try {
    return step();
  } catch (const Error& error) {
    throw Broken(what + ": " + error.what());
  }
}

void empty(const fs::path& folder) {
  fs::remove_all(folder);
  fs::create_directories(folder);
}

/// NaN is a value like any other.
bool same(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, [](float x, float y) {
    return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y) || (std::isnan(x) && std::isnan(y));
  });
}

void check_level(const scene::SceneDescription& scene, const Layers& level, std::size_t number) {
  const std::string where = fmt::format("level {}: ", number);
  const DepthGrid& grid = level.grid;
  require(scene::has_cell(grid.lattice), where + "no cell");
  const double room = 1e-5 * (1.0 + scene.height_max_m - scene.height_min_m);
  bool any_cell = false;
  for (int j = 0; j < grid.lattice.ny; ++j)
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t n = grid.lattice.index(i, j);
      const bool known = grid.state[n] != NodeState::unknown;
      require(known == !std::isnan(grid.height_m[n]), where + "a height without a state or a state without a height");
      require(!known || std::isfinite(grid.height_m[n]), where + "an infinite height");
      if (number == 0 && known) {
        const double z_m = grid.lattice.origin_m.z() + static_cast<double>(grid.height_m[n]);
        require(z_m >= scene.height_min_m - room && z_m <= scene.height_max_m + room, where + "a height out of range");
      }
      if (i > 0 && j > 0)
        any_cell |= known && grid.state[n - 1] != NodeState::unknown &&
                    grid.state[grid.lattice.index(i, j - 1)] != NodeState::unknown &&
                    grid.state[grid.lattice.index(i - 1, j - 1)] != NodeState::unknown;
      if (!level.envelope_m.empty())
        require(!known || std::isfinite(level.envelope_m[n]), where + "an envelope that is not finite");
      if (!level.curvature_per_m.empty())
        require(!std::isinf(level.curvature_per_m[n]), where + "a curvature that is infinite");
    }
  require(any_cell || number == 0, where + "no cell is known");
}

void touch(const haptics::HapticWindow& window) {
  const haptics::MongeSurface& surface = *window.surface;
  require(std::ranges::all_of(surface.height_m, [](float z) { return std::isfinite(z); }), "a touched height");
  for (const std::vector<float>* mu : {&surface.mu_dynamic, &surface.mu_static})
    require(std::ranges::all_of(*mu, [](float m) { return m >= 0.0F && m < 100.0F; }), "a coefficient of friction");
  haptics::DeviceInfo device;
  haptics::HapticRenderer renderer(device, {}, window);
  constexpr int kTicks = 120;
  for (int tick = 0; tick < kTicks; ++tick) {
    // From above through the middle and across to a corner.
    const double way = static_cast<double>(tick) / kTicks;
    haptics::DeviceSample sample;
    sample.position_m = {0.1 * std::max(0.0, way - 0.5), 0.12 * std::max(0.0, way - 0.5), 0.01 - 0.02 * way};
    sample.time_s = 0.001 * tick;
    sample.fresh = true;
    renderer.update(sample, 0.001);
    const haptics::State& state = renderer.state();
    for (const double f : state.commanded_force_n) require(std::abs(f) < 1e3, "a force");
    for (const double p : state.proxy_m) require(std::isfinite(p), "a place of the proxy");
  }
}

void touch_all(const scene::Scene& scene) {
  const scene::SceneDescription& description = scene.description();
  for (const haptics::ZoomStep& step : haptics::zoom_steps(description, scene::kDeskWorkspace_m)) {
    const scene::Lattice& lattice = description.levels.at(static_cast<std::size_t>(step.level));
    const Eigen::Vector2d low(lattice.x_m(0), lattice.y_m(0));
    const Eigen::Vector2d high(lattice.x_m(lattice.nx - 1), lattice.y_m(lattice.ny - 1));
    for (const Eigen::Vector2d& centre : {haptics::middle_of(lattice), low, high}) {
      must(fmt::format("touching level {}", step.level), [&] {
        touch(haptics::load_window(scene, haptics::plan_window(description, step, centre, scene::kDeskWorkspace_m), 1));
      });
    }
  }
}

void trace_all(const scene::Scene& scene) {
  const scene::SceneDescription& description = scene.description();
  for (std::size_t level = 0; level < description.levels.size(); ++level) {
    const auto number = static_cast<int>(level);
    const auto surface = must(fmt::format("tracing level {}", level), [&] {
      return haptics::make_surface(description, scene.read_level(number), number, 1.0, {});
    });
    std::vector<haptics::HipSample> path;
    for (int k = 0; k <= 20; ++k) {
      const double share = 0.05 * k;
      haptics::HipSample& sample = path.emplace_back();
      sample.t_s = 0.001 * k;
      sample.position_m = surface->centre_m + Eigen::Vector3d((share - 0.5) * surface->width_m(),
                                                              (0.5 - share) * surface->depth_m(), -1e-4);
    }
    const haptics::TraceResult result = haptics::trace(*surface, path, description.config.haptics, {});
    require(result.summary.not_a_number == 0, fmt::format("level {}: a trace that is not a number", level));
    for (const haptics::TraceRow& row : result.rows)
      require(row.proxy_m.allFinite() && row.force_n.allFinite(), fmt::format("level {}: a traced row", level));
  }
}

void export_all(const scene::Scene& scene, const fs::path& folder, Progress& progress) {
  for (const char* name : {"s.ply", "s.obj", "s.xyz", "s.tif", "s.png"})
    must(name, [&] { pipeline::export_scene(scene, folder / name, false, progress); });
  must("nodes.ply", [&] { pipeline::export_scene(scene, folder / "nodes.ply", true, progress); });
  try {
    static_cast<void>(pipeline::export_replica(scene, folder / "s.stl", {}, progress));
  } catch (const Error& error) {
    // A strip of nodes may be too narrow for a print, and says so.
    require(error.kind() == ErrorKind::input && error.wrong().find("narrow") != std::string::npos, error.what());
  }
}

void check_report(const pipeline::Report& report) {
  for (const double share : {report.coverage, report.filled_fraction})
    require(share >= 0.0 && share <= 1.0, "a share of nodes");
  if (!report.check) return;
  for (const pipeline::DistanceStatistics* s : {&report.check->cloud_to_surface, &report.check->surface_to_cloud}) {
    if (s->samples == 0) continue;
    for (const double distance : {s->mean_m, s->rms_m, s->median_m, s->p95_m, s->p99_m, s->max_m})
      require(std::isfinite(distance) && distance >= 0.0, fmt::format("a distance of the cross-check: {}", distance));
    require(s->median_m <= s->p95_m && s->p95_m <= s->p99_m && s->p99_m <= s->max_m, "percentiles out of order");
  }
  // On steep patches the second method's descent may end beside the nearest place, never the first method's search.
  require(report.check->second_method_max_difference_m <=
              0.5 * report.check->tolerance_m + 1e-6 * report.check->cloud_to_surface.max_m,
          fmt::format("two methods differ by {} m, tolerance {} m", report.check->second_method_max_difference_m,
                      report.check->tolerance_m));
}

// Points on disk and in memory give the same scene.
void compare(const scene::Scene& a, const scene::Scene& b) {
  require(a.description().levels.size() == b.description().levels.size(), "out of core: another number of levels");
  for (std::size_t level = 0; level < a.description().levels.size(); ++level) {
    const Layers x = a.read_level(static_cast<int>(level)), y = b.read_level(static_cast<int>(level));
    require(same(x.grid.height_m, y.grid.height_m), fmt::format("out of core: other heights of level {}", level));
    require(x.grid.state == y.grid.state && x.colour_rgba == y.colour_rgba && same(x.intensity, y.intensity),
            fmt::format("out of core: other layers of level {}", level));
  }
}

}  // namespace

void use_scene(const scene::ScenePointer& scene, const fs::path& folder) {
  empty(folder);
  Progress progress;
  const scene::SceneDescription& description = scene->description();
  for (std::size_t level = 0; level < description.levels.size(); ++level)
    check_level(description, scene->read_level(static_cast<int>(level)), level);
  const fs::path written = folder / "scene";
  fs::create_directories(written);
  must("writing", [&] { scene::write_scene(*scene, written); });
  const scene::ScenePointer opened =
      must("opening", [&] { return scene::open_scene(written, scene::Trust::any_file); });
  for (std::size_t level = 0; level < description.levels.size(); ++level) {
    const auto number = static_cast<int>(level);
    require(same(scene->read_level(number).grid.height_m, opened->read_level(number).grid.height_m),
            fmt::format("level {} is read with other heights than were written", level));
  }
  touch_all(*opened);
  trace_all(*opened);
  export_all(*opened, folder, progress);
}

bool go_whole_way(std::span<const std::uint8_t> bytes, const fs::path& folder) {
  Recipe recipe = recipe_of(bytes);
  empty(folder);
  const fs::path file = folder / recipe.name;
  std::ofstream(file, std::ios::binary) << recipe.scan;
  try {
    Progress progress;
    scene::Config config = recipe.config;
    config.scans.resize(1);
    config.scans.front().file = file;
    config.scans.front().units.unit = scene::LengthUnit::m;
    pipeline::BuildOptions options;
    options.threads = 1;
    options.force = true;
    options.scratch_folder = folder;
    pipeline::BuildResult built;
    try {
      static_cast<void>(pipeline::inspect_scan(file));
      if (recipe.suggested) {
        scene::Config suggested = pipeline::suggest_config({file}, folder, progress).config;
        suggested.levels = config.levels;
        config = suggested;
      }
      built = pipeline::build_scene(config, options, progress);
    } catch (const Error& error) {
      require(error.kind() == ErrorKind::input || error.kind() == ErrorKind::usage,
              std::string("a scan is refused as the program's own fault: ") + error.what());
      return false;
    }
    check_report(built.report);
    static_cast<void>(pipeline::report_json(*built.scene, built.report));
    use_scene(built.scene, folder / "use");
    ThreadPool pool(1);
    must("the report", [&] { pipeline::write_report(*built.scene, built.report, folder / "use", pool); });
    if (config.check) {
      const pipeline::Report again = must("check", [&] {
        return pipeline::recheck_scene(*built.scene, {}, *config.check, 1, progress, scene::Trust::any_file);
      });
      check_report(again);
    }
    if (recipe.points_at_once == 0) return true;
    options.memory_points = recipe.points_at_once;
    options.threads = 2;
    try {
      compare(*built.scene, *pipeline::build_scene(config, options, progress).scene);
    } catch (const Error& error) {  // faces, filters that need a cloud, many points about one node
      require(error.kind() == ErrorKind::failure, std::string("out of core: ") + error.what());
    }
    return true;
  } catch (const Broken& broken) {
    throw Broken(fmt::format("{} ({})", broken.what(), recipe.words));
  } catch (const Error& error) {
    throw Broken(fmt::format("{} ({})", error.what(), recipe.words));
  }
}

}  // namespace sparsha::test
