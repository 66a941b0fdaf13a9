// Configuration -> Scene: read, filter, project, then only the layers that the configuration asks for.
#include "pipeline/build/build.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/files/files.h"
#include "base/png/png_reader.h"
#include "base/system.h"
#include "base/text/text.h"
#include "base/threads/thread_pool.h"
#include "pipeline/build/empty_places.h"
#include "pipeline/build/on_ranks.h"
#include "pipeline/build/pillar_regions.h"
#include "pipeline/build/project_scans.h"
#include "pipeline/build/sides.h"
#include "pipeline/build/warnings.h"
#include "pipeline/charts/sheet_texture.h"
#include "pipeline/check/chart_errors.h"
#include "pipeline/check/check_map.h"
#include "pipeline/layers/layers.h"
#include "pipeline/outofcore/finished_tiles.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/projection/projection.h"
#include "pipeline/register/register.h"
#include "pipeline/scan/repeated.h"
#include "pipeline/scan/units.h"
#include "scene/area/regions.h"
#include "scene/folder/folder.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kMostNotes = 16U << 20U;  // bytes

// A jump between neighbouring nodes that is a step of the object and not its slope or noise.
double step_height(const Projection& projection) { return projection.gap_m; }

void count_nodes(const scene::DepthGrid& grid, Report& report, scene::SceneDescription& scene) {
  std::size_t measured = 0;
  std::size_t filled = 0;
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  for (std::size_t n = 0; n < grid.height_m.size(); ++n) {
    if (grid.state[n] == scene::NodeState::unknown) continue;
    (grid.state[n] == scene::NodeState::measured ? measured : filled) += 1;
    low = std::min(low, grid.height_m[n]);
    high = std::max(high, grid.height_m[n]);
  }
  const auto all = static_cast<double>(grid.height_m.size());
  report.coverage = static_cast<double>(measured) / all;
  report.filled_fraction = static_cast<double>(filled) / all;
  if (measured + filled > 0) {
    scene.height_min_m = grid.lattice.origin_m.z() + static_cast<double>(low);
    scene.height_max_m = grid.lattice.origin_m.z() + static_cast<double>(high);
  }
}

// Units of the formats are trusted, and where there is none the scan is doubted when it is read. `away_m`: see
// ScanSet::nearest_of_chosen_unit_m().
void warn_of_size(const scene::Lattice& lattice, std::optional<double> away_m, Progress& progress) {
  constexpr double kSmall_m = 0.005;  // smaller and larger objects are rare in a heritage lab
  constexpr double kLarge_m = 200.0;
  const double longest = lattice.spacing_m * (std::max(lattice.nx, lattice.ny) - 1);
  const bool plausible = longest >= kSmall_m && longest <= kLarge_m;
  if (!away_m || plausible || (longest > kLarge_m && !may_be_local(longest, *away_m))) return;
  progress.warn(fmt::format("the object is {} long; check 'units' of its scans{}", length_text(longest),
                            longest > kLarge_m ? " (millimetres read as metres?)" : " (metres read as millimetres?)"));
}

// White noise of the heights, a node: the points' own, averaged over as many as fall to a measured node.
double node_noise(const Projection& projection, const scene::DepthGrid& grid) {
  const auto measured = std::count(grid.state.begin(), grid.state.end(), scene::NodeState::measured);
  const double points = static_cast<double>(projection.used) / std::max(1.0, static_cast<double>(measured));
  return projection.noise_m / std::sqrt(std::max(1.0, points));
}

Report::Friction count_friction(const scene::DepthGrid& grid, const CurvatureMap& map) {
  Report::Friction count;
  for (std::size_t n = 0; n < grid.state.size(); ++n) {
    if (grid.state[n] == scene::NodeState::unknown) continue;
    ++count.nodes;
    count.undecided += std::isnan(map.rms_per_m[n]) ? 1 : 0;
  }
  return count;
}

// Texture and friction layers of level 0.
void add_texture(const scene::Config& config, const Projection& projection, const Context& context, scene::Layers& base,
                 scene::SceneDescription& scene, Report& report) {
  if (!config.texture) return;
  context.progress.begin("texture");
  base.envelope_m = bilateral_envelope(base.grid, *config.texture, context.pool);
  scene.has_envelope = true;
  if (!config.friction || config.friction->law == scene::FrictionConfig::Law::constant) return;
  context.progress.begin("friction map");
  scene::FrictionConfig& friction = *scene.config.friction;
  if (!(friction.scale_m > 0.0)) {
    friction.scale_m = std::max(3.0 * base.grid.lattice.spacing_m, config.texture->sigma_space_m);
  }
  const double noise_m = node_noise(projection, base.grid), step_m = step_height(projection);
  const std::vector<float> envelope_m =
      continued_envelope(base.grid, base.envelope_m, *config.texture, noise_m, step_m, context.pool);
  CurvatureMap map = texture_curvature(base.grid, envelope_m, friction.scale_m, noise_m, step_m, context.pool,
                                       config.texture->sigma_space_m);
  scene.friction_c_m = friction_slope(map, friction);
  report.friction = count_friction(base.grid, map);
  base.curvature_per_m = std::move(map.rms_per_m);
  scene.has_curvature = true;
  if (friction.law != scene::FrictionConfig::Law::paper) return;
  base.mean_curvature_per_m = std::move(map.mean_per_m);
  base.gaussian_curvature_per_m2 = std::move(map.gaussian_per_m2);
  scene.has_paper_curvatures = true;
}

// Texture of the sheets and its curvature, after that of the front view, whose friction law holds on all sides.
void add_texture_around(const scene::Config& config, const Context& context, scene::SceneDescription& scene,
                        scene::Charts& charts) {
  if (!config.texture) return;
  context.progress.begin("texture of charts");
  pipeline::add_texture(charts, *config.texture, context);
  if (!config.friction || config.friction->law != scene::FrictionConfig::Law::curvature) return;
  add_curvature(charts, scene.config.friction->scale_m, scene.noise_m, context);
}

// How the scans fit each other, for the report; poses stay as they are.
std::vector<ScanPair> pairs_of(const scene::Config& config, const BuildOptions& options, const Context& context) {
  std::vector<ScanPair> pairs;
  if (!config.registration || config.scans.size() < 2 || options.grid_only) return pairs;
  if (options.memory_bytes > 0) {
    context.progress.warn("with --memory, overlap and residual of the scans are not measured");
    return pairs;
  }
  std::vector<PairFit> fits;
  try {
    fits = measure_pairs(config.scans, *config.registration, context);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    context.progress.warn(std::string("overlap and residual of the scans are not measured: ") + error.what());
    return pairs;
  }
  std::vector<bool> linked(config.scans.size(), false);
  for (const PairFit& fit : fits) {
    const bool used = fit.use == PairFit::Use::used;
    const std::string first = config.scans[fit.first].file.generic_string();
    const std::string second = config.scans[fit.second].file.generic_string();
    pairs.push_back({first, second, {fit.after.within_m, fit.after.overlap, fit.after.residual_m}, used, std::nullopt});
    if (used) linked[fit.first] = linked[fit.second] = true;
    constexpr double kNotOne = 1.0 / 6.0;  // of the distance within which points are in common: half a point distance
    if (used && fit.after.residual_m > kNotOne * fit.after.within_m) {
      context.progress.warn(
          fmt::format("{} and {} lie {} apart (RMS) where they overlap; `sparsha register` finds poses", first, second,
                      length_text(fit.after.residual_m)));
    }
  }
  for (std::size_t s = 0; s < linked.size(); ++s) {
    if (linked[s]) continue;
    context.progress.warn(
        fmt::format("{} has less than {:.3g} % in common with every other scan; `sparsha register` finds "
                    "poses for scans that overlap",
                    config.scans[s].file.generic_string(), 100.0 * config.registration->min_overlap));
  }
  return pairs;
}

/// The label image lies over the grid that it was drawn for, also after the object has been turned.
void place_labels(scene::Config& config, const scene::Lattice& grid) {
  if (!config.audio || !config.audio->labels || config.audio->labels->bounds_m) return;
  if (config.orientation.regions_scan_to_grid)
    throw usage_error("audio.labels: the object was turned, and where the picture lies is not written", "bounds_m");
  config.audio->labels->bounds_m = {grid.x_m(0), grid.y_m(0), grid.x_m(grid.nx - 1), grid.y_m(grid.ny - 1)};
}

// Before a long build, not after it.
void require_label_image(const scene::Config& config) {
  if (!config.audio || !config.audio->labels) return;
  const auto has_label = [](const auto& place) { return place.label.has_value(); };
  if (std::any_of(config.parts.begin(), config.parts.end(), has_label) ||
      std::any_of(config.audio->regions.begin(), config.audio->regions.end(), has_label))
    static_cast<void>(read_number_png(config.audio->labels->file));
}

/// Of one view alone: what lies in boxes in space goes with the block that they need.
void without_sides(scene::Config& config) {
  config.around.reset();
  if (config.guide && !config.guide->line_in_space_m.empty()) config.guide.reset();
  std::erase_if(config.parts, [](const scene::PartConfig& part) { return part.solid_m.has_value(); });
  if (config.audio)
    std::erase_if(config.audio->regions,
                  [](const scene::AudioRegionConfig& region) { return region.solid_m.has_value(); });
}

// What is said of a whole object, with warnings of what was left out.
AroundReport around_of(const ChartResult& found, const std::function<ChartCheck(const scene::Charts&)>& check,
                       Progress& progress) {
  AroundReport report{found.charts.sheets.size(),
                      found.charts.measured_nodes(),
                      found.charts.spacing_m,
                      found.point_spacing_m,
                      found.noise_m,
                      found.discs,
                      found.discs_undecided,
                      found.discs_thin,
                      found.mixed_share,
                      found.small_sheet_nodes,
                      std::nullopt};
  constexpr double kSome = 0.001;
  const double all = static_cast<double>(std::max<std::uint64_t>(1, found.discs));
  const auto warn_of = [&](std::uint64_t count, std::uint64_t evidence, const char* why) {
    if (static_cast<double>(evidence) < kSome * all) return;
    progress.warn(fmt::format("around: {:.2g} % of the surface is undecided and left out: {}",
                              100.0 * static_cast<double>(count) / all, why));
  };
  warn_of(found.discs_undecided, found.discs_undecided, "nothing tells which side of it is outside");
  // One disc that stands opposite may be an error of noise, so that what it leaves out is no evidence of a wall.
  warn_of(found.discs_thin, found.discs_thin_agreed, "walls thinner than 2.3 point spacings, whose two faces mix");
  if (const auto doubt = doubt_of_mixed(found.mixed_share)) progress.warn(*doubt);
  if (check) {
    progress.begin("cross-check of charts");
    report.check = check(found.charts);
    if (const auto doubt = doubt_of_sides(report.check->sides)) progress.warn(*doubt);
  }
  return report;
}

scene::Layers base_of(Projection& projection) {
  scene::Layers base;
  base.grid = std::move(projection.grid);
  base.colour_rgba = std::move(projection.colour_rgba);
  base.intensity = std::move(projection.intensity);
  return base;
}

// Fills gaps, holds the points against the surface, and warns of what is odd. Throws Error{input} when the surface is
// not where the points are.
void fill_and_check(const scene::Config& config, const BuildOptions& options, const Context& context,
                    ProjectedScans& scans, scene::Layers& base, scene::SceneDescription& scene, Report& report) {
  Progress& progress = context.progress;
  const Projection& projection = scans.projection;
  if (config.fill) {
    progress.begin("fill");
    fill_gaps(base.grid, *config.fill, step_height(projection), context.pool);
  }
  const auto measured = static_cast<std::uint64_t>(
      std::count(base.grid.state.begin(), base.grid.state.end(), scene::NodeState::measured));
  // Before the other layers, so that points and layers are not in memory together.
  if (scans.check) {
    progress.begin("cross-check");
    report.check = scans.check(base.grid);
    scans.check = nullptr;
    if (!options.force) require_surface_near_points(projection, base.grid.lattice, *report.check);
    scene.check_map = check_map_of(base.grid, *report.check);
  }
  for (std::string& text : surface_warnings(projection, base.grid.lattice, measured, report.check)) {
    progress.warn(std::move(text));
  }
}

}  // namespace

BuildResult build_scene(const scene::Config& given, const BuildOptions& options, Progress& progress) {
  const auto began = std::chrono::steady_clock::now();
  if (options.ranks != nullptr) require_same_configuration(given, options);
  scene::Config config = given;
  require_label_image(config);
  config.scans = without_repeats(given.scans, progress);
  ThreadPool pool(threads_within(options.memory_bytes, options.threads));
  ProjectedScans scans = project_scans(config, options, {pool, progress});
  Projection& projection = scans.projection;

  Report report = take_counts(scans);
  report.pairs = pairs_of(config, options, {pool, progress});
  scene::SceneDescription scene;
  if (config.orientation.face) {
    config.orientation.face.reset();
    config.orientation.face_up.reset();
    config.orientation.scan_to_grid = scans.scan_to_grid;
  }
  if (scans.unroll) {
    config.unroll = scans.unroll;
    config.orientation.scan_to_grid = scans.scan_to_grid;
  }
  if (config.audio && config.audio->find_pillars) {
    progress.begin("pillars");
    // Regions are written in the frame of the configuration, however the object has been turned since.
    const Eigen::Matrix4d& view = config.orientation.regions_scan_to_grid.value_or(scans.scan_to_grid);
    place_on_pillars(*config.audio, find_pillars(scans.sample_m, progress), view, progress);
  }
  place_labels(config, projection.grid.lattice);
  scene.config = config;
  scene.sources = std::move(scans.sources);
  scene.scan_from_grid = config.orientation.scan_to_grid.inverse();
  if (config.orientation.regions_scan_to_grid) {
    scene.region_from_grid = *config.orientation.regions_scan_to_grid * scene.scan_from_grid;
  }
  scene.noise_m = projection.noise_m;
  warn_of_size(projection.grid.lattice, scans.nearest_of_chosen_unit_m, progress);

  if (scans.charts) {
    report.around = around_of(*scans.charts, scans.check_charts, progress);
    if (report.around->check) {
      add_errors(scans.charts->charts, *report.around->check, {pool, progress});
      report.around->check->places = {};
    }
  }
  scans.check_charts = nullptr;

  scene::Layers base = base_of(projection);
  scene.has_colour = !base.colour_rgba.empty();
  scene.has_intensity = !base.intensity.empty();
  if (scene.config.grid.size == 0) scene.config.grid.spacing_m = base.grid.lattice.spacing_m;

  std::vector<scene::Layers> levels;
  if (!options.grid_only) {
    fill_and_check(config, options, {pool, progress}, scans, base, scene, report);
    add_texture(config, projection, {pool, progress}, base, scene, report);
    if (scans.charts) add_texture_around(config, {pool, progress}, scene, scans.charts->charts);
    if (!scans.unroll && !scans.charts) add_sides(scans.scan_to_grid, report);
    progress.begin("pyramid");
    levels = build_pyramid(base, config.levels.window, pool);
  } else {
    if (const auto ignored = ignored_by_heights(config)) progress.warn(*ignored);
    without_sides(scene.config);
    scene.config.texture.reset();
    scene.config.friction.reset();
  }
  progress.finish();
  if (scans.charts) scene.charts = std::make_shared<const scene::Charts>(std::move(scans.charts->charts));

  count_nodes(base.grid, report, scene);
  levels.insert(levels.begin(), std::move(base));
  for (const scene::Layers& level : levels) scene.levels.push_back(level.grid.lattice);

  BuildResult result;
  result.disk_arrays = std::move(scans.disk_arrays);
  result.scene = scene::make_scene(std::move(scene), std::move(levels));
  warn_of_empty_places(result.scene->description(), progress);
  report.stages = progress.stages();
  report.warnings = progress.warnings();
  report.total_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  report.peak_rss_bytes = system::peak_rss_bytes();
  result.report = std::move(report);
  return result;
}

void write_scene_folder(const BuildResult& result, const std::filesystem::path& folder, Progress& progress) {
  const scene::Config& config = result.scene->description().config;
  scene::require_replaceable(folder, config);
  AtomicPath target(folder, AtomicPath::Kind::folder);
  progress.begin("write");
  target.naming_target([&] {
    scene::write_scene(*result.scene, target.temporary(), progress);
    ThreadPool pool(0);
    write_report(*result.scene, result.report, target.temporary(), pool);
  });
  progress.finish();
  progress.throw_if_cancelled();
  scene::require_replaceable(folder, config);
  target.commit();
}

namespace {

BuildOptions with_scratch_beside(BuildOptions options, const std::filesystem::path& folder) {
  if (options.scratch_folder.empty())
    options.scratch_folder = folder.parent_path().empty() ? std::filesystem::path(".") : folder.parent_path();
  return options;
}

}  // namespace

void take_part_in_build(const scene::Config& given, const BuildOptions& options, const std::filesystem::path& folder,
                        Progress& progress) {
  require_same_configuration(given, options);
  const BuildOptions building = with_scratch_beside(options, folder);
  scene::Config config = given;
  config.scans = without_repeats(given.scans, progress);
  ThreadPool pool(threads_within(building.memory_bytes, building.threads));
  (void)project_scans(config, building, {pool, progress});
}

namespace {

BuildResult build_and_write(const scene::Config& config, const BuildOptions& options,
                            const std::filesystem::path& folder, Progress& progress) {
  const auto began = std::chrono::steady_clock::now();
  scene::require_replaceable(folder, config);
  AtomicPath target(folder, AtomicPath::Kind::folder);
  BuildResult result = build_scene(config, with_scratch_beside(options, folder), progress);
  progress.begin("write");
  target.naming_target([&] { scene::write_scene(*result.scene, target.temporary(), progress); });
  progress.finish();
  result.report.stages = progress.stages();
  result.report.warnings = progress.warnings();
  result.report.total_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  result.report.peak_rss_bytes = system::peak_rss_bytes();
  target.naming_target([&] {
    if (options.grid_only) {
      write_file(target.temporary() / "report.json", report_json(*result.scene, result.report));
    } else {
      ThreadPool pool(threads_within(options.memory_bytes, options.threads));
      write_report(*result.scene, result.report, target.temporary(), pool);
    }
  });
  progress.throw_if_cancelled();
  scene::require_replaceable(folder, config);  // once more: a build takes its time
  // Notes are people's work, and in the frame of the scans: they go on with the object.
  std::error_code code;
  if (const std::filesystem::path notes = folder / scene::kNotesFile; std::filesystem::is_regular_file(notes, code))
    write_file(target.temporary() / scene::kNotesFile, read_file(notes, kMostNotes));
  target.commit();
  // Also those that an earlier build has left, which was ended.
  if (!options.finished_tiles.empty()) remove_finished_tiles(options.finished_tiles);
  return result;
}

}  // namespace

BuildResult build_scene_folder(const scene::Config& config, const BuildOptions& options,
                               const std::filesystem::path& folder, Progress& progress) try {
  return build_and_write(config, options, folder, progress);
} catch (const std::bad_alloc&) {
  system::throw_if_disk_was_full();
  throw;
}

}  // namespace sparsha::pipeline
