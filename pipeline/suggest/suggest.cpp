// Guesses a configuration from the points alone, tries it, and says why.
#include "pipeline/suggest/suggest.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "base/error.h"
#include "base/files/paths.h"
#include "base/text/text.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "base/yaml/yaml_text.h"
#include "pipeline/orient/mantle.h"
#include "pipeline/orient/thumbnails.h"
#include "pipeline/outofcore/memory.h"
#include "pipeline/scan/empty_scan.h"
#include "pipeline/scan/named_file.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/pieces.h"
#include "pipeline/scan/reader.h"
#include "pipeline/scan/repeated.h"
#include "pipeline/scan/statistics.h"
#include "pipeline/scan/straight.h"
#include "pipeline/scan/units.h"
#include "pipeline/scan/up_axes.h"
#include "pipeline/suggest/floors.h"
#include "pipeline/suggest/group.h"
#include "pipeline/suggest/search.h"
#include "pipeline/suggest/trial.h"
#include "pipeline/suggest/view.h"
#include "pipeline/suggest/worth_block.h"

namespace sparsha::pipeline {
namespace fs = std::filesystem;

namespace {

std::string vector(const Eigen::Vector3d& v) { return fmt::format("[{:g}, {:g}, {:g}]", v.x(), v.y(), v.z()); }

// Whether the scan's main object is of a plausible size in metres, though strays far away make the scan large.
bool plausible_metres(const RawScan& scan) {
  const auto group = main_group(scan.points);
  return group && !doubt_metres(group->crop.min_m, group->crop.max_m);
}

std::string precise(const Eigen::Vector3d& v) { return fmt::format("[{:.3f}, {:.3f}, {:.3f}]", v.x(), v.y(), v.z()); }

// What the trial found, as comments.
std::string verdict(const Choice& choice, double share) {
  const Trial& trial = choice.trial;
  std::string text = fmt::format("#   {}\n", trial.view.reason);
  if (!choice.rejected.empty()) text += fmt::format("#   the first guess was: {}\n", choice.rejected);
  if (!trial.fits) {
    return text + fmt::format("#   THE CROSS-CHECK FAILS, from here and all other sides that were tried: {}\n",
                              trial.complaint());
  }
  text += fmt::format("#   tried{}: {} within {} of the surface, {:.0f} % of the grid is measured\n",
                      share < 1.0 ? fmt::format(" with {:.2g} % of the points", 100.0 * share) : "",
                      half_of(trial.against), length_text(trial.median_m), 100.0 * trial.coverage);
  if (!trial.complaint().empty()) text += fmt::format("#   look at the result: {}\n", trial.complaint());
  constexpr double kEmpty = 0.05;
  if (trial.coverage < kEmpty) {
    text +=
        "#   most of the grid is empty: 'grid.bounds_m' or a crop filter chooses one of objects that lie far apart\n";
  }
  return text;
}

// The other sides, ready to be taken instead.
std::string other_sides(const View& front) {
  std::string text = "#   its other sides, in place of that line:\n";
  for (const NamedView& side : six_sides(front.look_from, front.up)) {
    if (side.name == "front") continue;
    text += fmt::format("# orientation: {{look_from: {}, up: {}}}  # {}\n", vector(side.look_from), vector(side.up),
                        side.name);
  }
  return text;
}

std::string other_side(const View& front) {
  return fmt::format("# orientation: {{look_from: {}, up: {}}}  # its other side, if what is raised feels sunken\n",
                     vector(rounded_direction(-front.look_from)), vector(front.up));
}

// A unit of a scan, what it is in metres, and why it is taken.
struct FoundUnit {
  std::string name = "m";
  std::string reason = "no sign of another unit";
  double metres = 1.0;
};
FoundUnit unit_of(const RawScan& scan) {
  if (scan.unit) return {to_string(*scan.unit), "the format says so", scene::metres_in(*scan.unit)};
  if (const auto guess = guess_unit(scan); guess && !plausible_metres(scan)) {
    if (guess->may_be_metres)
      return {"m", fmt::format("{}: set '{}' if that is right", guess->reason, to_string(guess->unit)), 1.0};
    return {to_string(guess->unit), guess->reason, scene::metres_in(guess->unit)};
  }
  return {};
}

// What is known of each scan's size without its unit.
std::vector<ScanSize> sizes_of(const std::vector<fs::path>& files, const std::vector<ScanStatistics>& scans) {
  std::vector<ScanSize> sizes;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const RawScan& scan = scans[s].scan;
    const double metres = scene::metres_in(scan.unit.value_or(scene::LengthUnit::automatic));
    PointSample sample;
    for (const Eigen::Vector3d& p : scan.points) sample.add(p * metres);
    sizes.emplace_back(files[s].string(), sample.points(), scan.records - scan.invalid, scan.unit.has_value());
  }
  return sizes;
}

// The units of scans of one object. Files that name none were written by one program, so that one of which metres
// cannot be true tells the unit of them all: a detail has a plausible size in any unit. Unless their sizes tell that
// the units differ.
std::vector<FoundUnit> units_of(const std::vector<fs::path>& files, const std::vector<ScanStatistics>& scans,
                                Progress& progress) {
  std::vector<FoundUnit> units;
  for (const ScanStatistics& statistics : scans) units.push_back(unit_of(statistics.scan));
  const auto name = [&](std::size_t s) { return "\"" + files[s].filename().string() + "\""; };
  std::vector<bool> told(scans.size());
  for (const UnitDifference& difference : differing_units(sizes_of(files, scans))) {
    progress.warn(difference.reason);
    const double times = scene::metres_in(difference.of_small) / scene::metres_in(difference.of_large);
    const auto tell = [&](std::size_t s, scene::LengthUnit unit, const std::string& reason) {
      if (!scans[s].scan.unit) units[s] = {to_string(unit), reason, scene::metres_in(unit)};
      told[s] = true;
    };
    tell(difference.large, difference.of_large,
         fmt::format("about {:.0f} times as large as {}, and its points as far apart", times, name(difference.small)));
    tell(difference.small, difference.of_small,
         fmt::format("about {:.0f} times smaller than {}, and its points as much nearer to each other", times,
                     name(difference.large)));
  }
  const auto tells = [&](std::size_t s) { return !told[s] && !scans[s].scan.unit && units[s].metres != 1.0; };
  std::size_t teller = 0;
  while (teller < units.size() && !tells(teller)) ++teller;
  for (std::size_t s = 0; teller < units.size() && s < units.size(); ++s) {
    if (scans[s].scan.unit || told[s] || tells(s)) continue;
    units[s] = units[teller];
    units[s].reason = fmt::format("as {}: {}", name(teller), units[teller].reason);
  }
  return units;
}

// As the configuration in `folder` finds it: an absolute path stays one, another is relative to the folder.
std::string shown_path(const fs::path& file, const fs::path& folder) {
  if (file.is_absolute()) return file.generic_string();
  return path_from(folder, file).generic_string();
}

// The columns of a text table that names none, where its values tell them.
std::string columns_text(const RawScan& scan) {
  if (!scan.table || scan.table->by != TextTable::By::shape) return {};
  return fmt::format("    columns: [{}]  # no header; told by the values\n", fmt::join(scan.table->columns, ", "));
}

// Damaged coordinates are those of one scan.
void require_extent(const std::string& name, const std::vector<Eigen::Vector3d>& points_m) {
  const InnerBox box = inner_box(points_m);
  const double longest_m = (box.high - box.low).maxCoeff();
  constexpr double kLongest_m = 1e9;
  if (longest_m <= kLongest_m) return;
  throw input_error(name, fmt::format("its points spread over {:.3g} m", longest_m),
                    "a scan of less than 1e9 m; damaged coordinates or another unit");
}

ScanStatistics statistics_of(const fs::path& file, std::uint64_t kept, const MeshRefusal& refusal,
                             const SuggestOptions& options, Progress& progress) {
  ScanStatistics statistics = scan_statistics(file, progress, kept, refusal, options.whole_chunks_only);
  if (statistics.scan.points.empty() && statistics.scan.faces.empty() && statistics.empty_returns > 0)
    throw all_empty_returns(file.string(), statistics.empty_returns);
  if (statistics.scan.points.empty())
    throw EmptyScan(file.string(), "there are no points in it", "a scan with at least one finite point");
  return statistics;
}

// What an error names that is found in all scans together.
struct ScanNames {
  std::vector<std::string> files;
  std::size_t farthest = 0;  // index of the one with points farthest from zero
  double away_m = -1.0;

  void add(const std::string& file, std::span<const Eigen::Vector3d> points_m) {
    double away = 0.0;
    for (const Eigen::Vector3d& p : points_m) away = std::max(away, p.cwiseAbs().maxCoeff());
    if (away > away_m) {
      farthest = files.size();
      away_m = away;
    }
    files.push_back(file);
  }
  [[nodiscard]] std::string all() const { return names_together(files); }
};

// Reads the scans into `names`, `seen`, `points` and `worth`; their part of the configuration, where those without a
// point are comments. `pieces`: what is to be said of those in several.
std::string look_at(const std::vector<fs::path>& files, const fs::path& folder, ScanNames& names, SeenScans& seen,
                    TrialCloud& points, std::vector<std::string>& pieces, WorthBlock& worth,
                    const SuggestOptions& options, Progress& progress) {
  // Points of all scans beyond which the files are gone through again, with the same result.
  constexpr std::uint64_t kMostKept = 4'000'000;
  const MemoryLimit limit{options.memory_bytes, 0};
  const std::uint64_t kept = points_to_keep(limit, kMostKept) / files.size();
  const MeshRefusal refusal = mesh_refusal(limit, {}, 0, true);
  std::vector<ScanStatistics> all;
  std::vector<fs::path> scans;  // those with points
  std::optional<EmptyScan> empty;
  std::string text = "scans:\n";
  for (const fs::path& file : files) {
    try {
      all.push_back(statistics_of(file, kept, refusal, options, progress));
    } catch (const EmptyScan& found) {
      if (!empty) empty = found;
      text += fmt::format("  # left out: {}\n", yaml::comment(found.what()));
      if (files.size() > 1) progress.warn(left_out_warning(found));
      continue;
    }
    scans.push_back(file);
    for (const std::string& warning : all.back().scan.warnings) progress.warn(file.string() + ": " + warning);
    require_lengths(all.back().scan, file.string());
  }
  if (scans.empty()) throw *empty;
  const std::vector<FoundUnit> units = units_of(scans, all, progress);
  std::vector<ScanUp> ups;
  for (std::size_t s = 0; s < scans.size(); ++s) ups.push_back({scans[s].string(), all[s].scan.format});
  if (const std::optional<UpDifference> difference = differing_up(ups)) {
    progress.warn(difference->reason);
    text += fmt::format("  # {}\n", yaml::comment(difference->reason));
  }
  std::vector<std::string> apart;  // what is said of points' pieces
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const std::string columns = columns_text(all[s].scan);
    const std::size_t first = seen.points_m.size();
    seen.look_at(all[s], units[s].metres);
    require_extent(scans[s].string(),
                   {seen.points_m.begin() + static_cast<std::ptrdiff_t>(first), seen.points_m.end()});
    names.add(scans[s].string(), std::span(seen.points_m).subspan(first));
    points.add(all[s], units[s].metres);
    text += fmt::format("  - file: {}\n    units: {}  # {}\n{}", yaml::quoted(shown_path(scans[s], folder)),
                        units[s].name, yaml::comment(units[s].reason), columns);
    if (!all[s].scan.pieces.empty()) {
      (all[s].scan.faces.empty() ? apart : pieces).push_back(scans[s].string() + ": " + all[s].scan.pieces);
    }
    for (const std::string& warning : all[s].scan.warnings) text += fmt::format("    # {}\n", yaml::comment(warning));
    worth.add(scans[s].filename().string(), all[s].worth, progress);
    all[s] = {};
  }
  if (apart_together(scans.size(), seen.points_m)) pieces.insert(pieces.end(), apart.begin(), apart.end());
  return text;
}

// Crops what is seen to the group in which nearly all points lie; the filters' part of the configuration.
std::string crop_to_group(SeenScans& seen, TrialCloud& points, Progress& progress) {
  const auto group = points.has_faces() ? std::nullopt : main_group(seen.points_m);
  if (!group) return {};
  const std::string what =
      fmt::format("{:.1f} % of the points lie together, the others far away", 100.0 * group->share);
  progress.warn(what + ", and are cropped: a grid over all of them would show none; name another 'crop' to see them");
  seen.crop(group->crop);
  points.crop(group->crop);
  return fmt::format("  - crop: {{min_m: {}, max_m: {}}}  # {}\n", precise(group->crop.min_m),
                     precise(group->crop.max_m), what);
}

// With what is around the object, and without it.
struct Ways {
  Choice choice;
  Sides sides;
  bool planes_go = false;
  std::string filters;  // their lines; as comments where the planes stay
};

std::string outcome(const Choice& choice) {
  const Trial& trial = choice.trial;
  if (!trial.fits) return "fails the cross-check: " + trial.complaint();
  return fmt::format("{} within {} of the surface, {:.0f} % of the grid is measured, from {}", half_of(trial.against),
                     length_text(trial.median_m), 100.0 * trial.coverage, vector(trial.view.look_from));
}

// Whether one of the planes lies before all else, as the scanners saw it: a wall with a niche in it, or walls of a room
// from within.
bool are_before(const SeenScans& seen, const FloorsAndWalls& around) {
  return std::ranges::any_of(around.planes, [&](const FloorsAndWalls::Plane& plane) {
    std::size_t behind = 0;
    for (const SeenScans::FromStation& from : seen.from_stations)
      behind += plane.normal.dot(from.place_m) < plane.offset_m ? 1 : 0;
    return 2 * behind > seen.from_stations.size();
  });
}

Ways try_ways(const SeenScans& seen, TrialCloud& points, const std::optional<Eigen::Vector3d>& up, Progress& progress) {
  ThreadPool pool(0);
  FloorsAndWalls around =
      points.has_faces() ? FloorsAndWalls() : find_floors_and_walls(seen.points_m, {pool, progress});
  if (are_before(seen, around)) around = {};
  Ways whole;
  TrialCloud object = points;
  whole.sides = sides_of(seen, up);
  whole.choice = find_view_and_spacing(points, whole.sides, inner_box(seen.points_m), progress);
  if (around.planes.empty()) return whole;
  Ways alone;
  SeenScans left = seen;
  left.take_away(around);
  object.take_away(around);
  alone.sides = sides_of(left, up);
  alone.choice = find_view_and_spacing(object, alone.sides, inner_box(left.points_m), progress);
  const bool go = alone.choice.trial.fits;
  std::string lines = to_text(around, go ? "  - " : "#  - ");
  for (const FloorsAndWalls::Plane& plane : around.planes) {
    if (go) progress.warn(plane.reason + "; a filter 'remove_plane' takes it away");
  }
  lines += fmt::format("#   without what is around it: {}\n#   with it: {}\n", yaml::comment(outcome(alone.choice)),
                       yaml::comment(outcome(whole.choice)));
  Ways& taken = go ? alone : whole;
  taken.planes_go = go;
  taken.filters = std::move(lines);
  return std::move(taken);
}

// A line that lays the mantle of a column or a vase flat, for those who take out its '#'. Only where no filter changes
// what is seen.
std::string round_hint(const SeenScans& seen, const Sides& sides, bool filtered) {
  constexpr std::size_t kEnough = 6'000;
  if (!sides.standing || sides.standing->room || filtered) return {};
  const std::vector<Eigen::Vector3d>& all = seen.triangles_m.empty() ? seen.points_m : seen.triangles_m;
  std::vector<Eigen::Vector3d> sample;
  const std::size_t step = std::max<std::size_t>(1, all.size() / kEnough);
  for (std::size_t k = 0; k < all.size(); k += step) sample.push_back(all[k]);
  const std::optional<FoundMantle> mantle = mantle_of_round(sample, sides.standing->up);
  if (!mantle) return {};
  return fmt::format("# unroll: {{axis: auto}}  # it is round: this line lays it flat, all around ({})\n",
                     mantle->reason);
}

/// A line that builds all sides of what has several, for those who take out its '#'.
std::string around_hint(const Sides& sides) {
  if (!sides.standing || (sides.standing->room && !sides.standing->from_within)) return {};
  return sides.standing->from_within ? "# around: {}  # this line builds all its walls, which are touched from within\n"
                                     : "# around: {}  # this line builds all its sides: the whole object is touched\n";
}

/// The files without those of the same bytes: a build takes each once, and so does the guess.
std::vector<fs::path> files_once(const std::vector<fs::path>& files, Progress& progress) {
  std::vector<scene::ScanConfig> scans;
  for (const fs::path& file : files) scans.emplace_back().file = file;
  std::vector<fs::path> once;
  for (scene::ScanConfig& scan : without_repeats(scans, progress)) once.push_back(std::move(scan.file));
  return once;
}

}  // namespace

Suggestion suggest_config(const std::vector<fs::path>& scans, const fs::path& folder, Progress& progress,
                          const SuggestOptions& options) {
  progress.begin("look at the scans");
  SeenScans seen;
  TrialCloud points;
  std::vector<std::string> pieces;
  WorthBlock worth;
  ScanNames names;
  const std::string scan_block =
      look_at(files_once(scans, progress), folder, names, seen, points, pieces, worth, options, progress);
  require_extent(names.files[names.farthest], seen.points_m);
  require_surface(names.all(), names.files.size(), seen.points_m, seen.points_m.size());
  const std::string crop = crop_to_group(seen, points, progress);
  std::string filter_block = worth.comments();
  if (crop.empty()) {
    for (const std::string& sentence : pieces) {
      progress.warn(sentence);
      filter_block += "# " + yaml::comment(sentence) + "\n";
    }
  }
  const bool filtered = !worth.filters().empty() || !crop.empty();
  if (filtered) filter_block += "filters:\n" + worth.filters() + crop;
  progress.begin("try views");
  const double share = points.share();
  const Ways ways = try_ways(seen, points, options.up, progress);
  const Choice& choice = ways.choice;
  if (!filtered && ways.planes_go) filter_block += "filters:\n";
  filter_block += ways.filters;
  const View& view = choice.trial.view;
  const double spacing_mm = (choice.spacing_m > 0.0 ? choice.spacing_m : 0.001) * 1e3;
  if (choice.no_surface && !options.settings_follow) {
    throw input_error(names.all(), choice.trial.error, "points that spread over a surface");
  }
  if (!choice.trial.fits) {
    progress.warn(
        fmt::format("no view and spacing that was tried passes the cross-check; from the likeliest side: {}; choose "
                    "orientation and "
                    "grid.spacing_mm yourself, or crop the scan to one surface",
                    choice.trial.complaint()));
  }

  std::string yaml = "# A first configuration, guessed from the scans: read it, look at the scene, correct it.\n";
  yaml += scan_block;
  yaml += filter_block;
  yaml += fmt::format("orientation: {{look_from: {}, up: {}}}\n", vector(view.look_from), vector(view.up));
  yaml += verdict(choice, share);
  if (ways.sides.standing) yaml += other_sides(view);
  if (ways.sides.other_side && !ways.sides.standing && view.look_from == ways.sides.views.front().look_from)
    yaml += other_side(view);
  yaml += round_hint(seen, ways.sides, filtered || ways.planes_go);
  yaml += around_hint(ways.sides);
  yaml += fmt::format("grid: {{spacing_mm: {}{}}}  # {}{}\n",
                      choice.exact_spacing ? fmt::format("{:.12g}", spacing_mm) : written_mm(1e-3 * spacing_mm),
                      seen.colours ? ", colour: true" : "", choice.spacing_reason,
                      seen.colours ? "; the scans have colours" : "");
  yaml += fmt::format("fill: {{max_gap_mm: {:.3g}}}  # five spacings: small holes, no invented surface\n",
                      5.0 * spacing_mm);
  yaml += fmt::format(
      "texture: {{sigma_space_mm: {:.3g}, sigma_range_mm: {:.3g}}}  # three spacings, and a height of one\n",
      3.0 * spacing_mm, spacing_mm);
  yaml += "friction: {law: curvature}\ncheck: {samples: 50000}\n";
  yaml +=
      "cues: {level: off, edge: both, unmeasured: both, part_entered: off, part_left: off}  # a hand that leaves the "
      "stone is told so\n";

  Suggestion suggestion;
  suggestion.config = scene::parse_config(yaml::parse_text(yaml, "the suggested configuration"), folder);
  suggestion.yaml = std::move(yaml);
  if (ways.sides.open && ways.sides.object)
    suggestion.sides = six_thumbnails(*ways.sides.object, view.look_from, view.up);
  progress.finish();
  return suggestion;
}

}  // namespace sparsha::pipeline
