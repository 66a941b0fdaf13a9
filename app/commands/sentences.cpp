#include "app/commands/sentences.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "app/commands/point_fields.h"
#include "app/words/sentences.h"
#include "base/text/text.h"
#include "pipeline/scan/worth.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace {

/// Of the distances between two things: how far most, nearly all and all of them are.
std::string distances(const char* from, const char* to, const pipeline::DistanceStatistics& s) {
  if (s.samples == 0) return fmt::format("There is nothing from which {} could be measured to {}.\n", from, to);
  return fmt::format(
      "{} from {} to {} were measured: the mean is {}, half are within {}, 95 percent within {}, 99 percent within {}, "
      "and the largest is {}.\n",
      counted(s.samples, "distance", "distances"), from, to, exact_length(s.mean_m), exact_length(s.median_m),
      exact_length(s.p95_m), exact_length(s.p99_m), exact_length(s.max_m));
}

std::string fit_words(const pipeline::PairFit::Fit& fit) {
  std::string text = fmt::format("{} overlapped", percent(fit.overlap));
  if (fit.matches > 0) text += fmt::format(", {} apart", exact_length(fit.residual_m));
  return text;
}

const char* use_words(pipeline::PairFit::Use use) {
  switch (use) {
    case pipeline::PairFit::Use::used:
      return "The pair was used";
    case pipeline::PairFit::Use::weak:
      return "The pair was not used alone, since what it has in common can slide";
    case pipeline::PairFit::Use::rejected:
      return "The pair was rejected, since it contradicts the others";
    case pipeline::PairFit::Use::none:
      break;
  }
  return "The pair was not used, since it has too little in common";
}

/// Without the full stop that a sentence around it has.
std::string inner(std::string text) {
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

}  // namespace

std::string check_sentences(const pipeline::CheckResult& check) {
  const char* const against = pipeline::words_of(check.against);
  std::string text = distances(against, "the surface", check.cloud_to_surface) +
                     distances("nodes of the surface", against, check.surface_to_cloud);
  if (check.completeness) text += fmt::format("The surface is {} complete.\n", percent(*check.completeness));
  return text;
}

std::string device_check_sentences(const haptics::CheckReport& report) {
  constexpr std::array<const char*, 3> kResults{"has passed", "has failed", "was skipped"};
  std::string text;
  for (const haptics::CheckStep& step : report.steps) {
    text += fmt::format("The step {} {}", step.name, kResults.at(static_cast<std::size_t>(step.result)));
    text += step.detail.empty() ? ".\n" : fmt::format(": {}.\n", inner(step.detail));
    if (!step.remedy.empty()) text += fmt::format("The remedy is this: {}.\n", inner(step.remedy));
  }
  if (report.link.asked > 0) text += fmt::format("The link is {}.\n", haptics::name_of(report.verdict.grade));
  return text;
}

std::string modes_sentences(const std::vector<scene::ModeConfig>& modes) {
  std::string text = fmt::format("The strike has {}.\n", counted(modes.size(), "mode", "modes"));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const scene::ModeConfig& mode = modes[k];
    text += fmt::format("Mode {} is at {:.3f} hertz, falls by 60 decibels in {:.4f} seconds", k + 1, mode.frequency_hz,
                        mode.decay_s);
    text += k == 0 ? " and is the loudest.\n"
                   : fmt::format(" and is {:.2f} decibels softer than the first.\n", std::abs(mode.level_db));
  }
  return text;
}

std::string registration_sentences(const scene::Config& config, const pipeline::Registration& found) {
  const auto name = [&](std::size_t scan) { return config.scans.at(scan).file.filename().string(); };
  std::string text;
  for (const pipeline::FirstGuess& guess : found.guesses)
    text += fmt::format("Features were found that put the scan {} on {}, {} of it.\n", name(guess.scan), name(guess.on),
                        percent(guess.overlap));
  for (const pipeline::PairFit& pair : found.pairs)
    text += fmt::format("Of the scans {} and {}, {} before, and {} after they were registered. {}.\n", name(pair.first),
                        name(pair.second), fit_words(pair.before), fit_words(pair.after), use_words(pair.use));
  if (!found.pairs.empty())
    text += fmt::format("Points were compared that are within {} of each other before, and within {} after.\n",
                        exact_length(found.pairs.front().before.within_m),
                        exact_length(found.pairs.front().after.within_m));
  return text;
}

std::string replica_sentences(const pipeline::ReplicaReport& report) {
  std::string text =
      fmt::format("The replica is {} wide, {} long and {} thick.\n", exact_length(1e-3 * report.width_mm),
                  exact_length(1e-3 * report.length_mm), exact_length(1e-3 * report.thickness_mm));
  text += fmt::format("Its scale is 1 to {}, and depths are {} times what that scale gives.\n",
                      value_text(1.0 / report.scale), value_text(report.raised));
  text += fmt::format("The solid is made of {} and has {} cubic centimetres.\n",
                      counted(report.triangles, "triangle", "triangles"), value_text(1e-3 * report.volume_mm3, 4));
  text += fmt::format("Of the relief {} has features that fingers notice, and {} is too fine to be told apart.\n",
                      percent(report.felt), percent(report.crowded));
  for (const std::string& line : report.lines) text += fmt::format("The name {} is written in Braille.\n", inner(line));
  return text;
}

std::string whole_replica_sentences(const pipeline::WholeReplicaReport& report) {
  std::string text = fmt::format("The replica is {} wide, {} deep and {} high.\n", exact_length(1e-3 * report.width_mm),
                                 exact_length(1e-3 * report.depth_mm), exact_length(1e-3 * report.height_mm));
  text += fmt::format("Its scale is 1 to {}.\n", value_text(1.0 / report.scale));
  text += fmt::format("The solid is made of {} and has {} cubic centimetres.\n",
                      counted(report.triangles, "triangle", "triangles"), value_text(1e-3 * report.volume_mm3, 4));
  return text;
}

std::string scan_sentences(const std::filesystem::path& file, const pipeline::ScanInfo& info) {
  std::string text = fmt::format("The file {} is a scan in the format {} and has {}.\n", file.string(), info.format,
                                 counted(info.points, "point", "points"));
  if (info.invalid > 0)
    text += fmt::format("Of them, {} invalid.\n", info.invalid == 1 ? "1 is" : fmt::format("{} are", info.invalid));
  if (info.duplicates > 0)
    text += fmt::format("Of them, {} another one.\n",
                        info.duplicates == 1 ? "1 is the same as" : fmt::format("{} are the same as", info.duplicates));
  if (info.triangles > 0)
    text += fmt::format("It is a mesh of {}.\n", counted(info.triangles, "triangle", "triangles"));
  if (info.scans != 1) text += fmt::format("It is made of {}.\n", counted(info.scans, "scan", "scans"));
  const bool metric = info.units != "unknown" && info.units != "degrees";
  text += metric ? fmt::format("Its unit is {}.\n", info.units)
                 : fmt::format("Its unit is {}, so that lengths are the file's own numbers.\n", info.units);
  const auto length = [&](double value) { return metric ? exact_length(value) : value_text(value, 6); };
  if (info.points > info.invalid) {
    const Eigen::Vector3d size = info.max_m - info.min_m;
    text +=
        fmt::format("It is {} long in x, {} in y and {} in z.\n", length(size.x()), length(size.y()), length(size.z()));
    text += fmt::format("It begins where x is {}, y is {} and z is {}.\n", length(info.min_m.x()),
                        length(info.min_m.y()), length(info.min_m.z()));
    if (info.spacing_m > 0.0)
      text += fmt::format("Neighbouring points are {} apart in the median.\n", length(info.spacing_m));
  }
  text += fmt::format("Each point has the fields {}.\n", fmt::join(info.fields, ", "));
  for (const pipeline::FieldTally& tally : info.tallies) {
    if (is_worth_showing(tally))
      text += fmt::format("The field {} is {}.\n", tally.name(), field_words(tally, " percent"));
  }
  for (const pipeline::Worth& worth : pipeline::worth_of(info.tallies)) {
    text += fmt::format("The scan says this of its points: {}.\n", worth.reason);
    if (worth.filter) text += fmt::format("The filter {} leaves them out.\n", worth.text());
  }
  if (info.viewpoint)
    text += fmt::format("The file has a viewpoint, {}, which is not applied.\n", fmt::join(*info.viewpoint, ", "));
  for (const std::string& warning : info.warnings) text += fmt::format("There is a warning: {}.\n", inner(warning));
  return text;
}

std::string scene_sentences(const std::filesystem::path& folder, const scene::SceneDescription& scene) {
  const scene::Lattice& base = scene.levels.front();
  std::string text = fmt::format("The folder {} is a Sparsha scene, made from {}.\n", folder.string(),
                                 counted(scene.sources.size(), "scan", "scans"));
  text +=
      fmt::format("The scene is {} wide, {} high and {} deep.\n", exact_length((base.nx - 1) * base.spacing_m),
                  exact_length((base.ny - 1) * base.spacing_m), exact_length(scene.height_max_m - scene.height_min_m));
  for (std::size_t level = 0; level < scene.levels.size(); ++level) {
    const scene::Lattice& lattice = scene.levels[level];
    text += fmt::format("Level {} has {} times {} nodes, {} apart.\n", level, lattice.nx, lattice.ny,
                        exact_length(lattice.spacing_m));
  }
  return text;
}

std::string trace_sentences(const haptics::TraceSummary& s, const std::string& file) {
  std::string text = fmt::format("The path has {}, and the stone is touched in {} of them.\n",
                                 counted(s.updates, "update", "updates"), s.contacts);
  text += fmt::format(
      "Half of the updates took {:.0f} nanoseconds or less, 99 percent took {:.0f} or less, and the longest took "
      "{:.0f}.\n",
      s.ns_p50, s.ns_p99, s.ns_max);
  text += fmt::format("The residual is {} cells at the 99th percentile, and {} at most.\n",
                      value_text(s.residual_cells_p99, 2), value_text(s.residual_cells_max, 2));
  text += fmt::format("In {} the proxy was below the surface, in {} it was not a number, and {} unfinished.\n",
                      counted(s.below_surface, "update", "updates"), s.not_a_number,
                      s.unfinished == 1 ? "1 was" : fmt::format("{} were", s.unfinished));
  if (s.around)
    text += fmt::format(
        "The proxy touched {} of {} sheets of the whole object, went over to another sheet {}, of these {} "
        "across an edge, and was let go {} where the surface ends.\n",
        s.around->touched, s.around->sheets, counted(s.around->hand_overs + s.around->edges, "time", "times"),
        s.around->edges, counted(s.around->releases, "time", "times"));
  return text + written_sentences({file});
}

std::string written_sentences(const std::vector<std::filesystem::path>& files) {
  std::string text;
  for (const std::filesystem::path& file : files) text += fmt::format("The file {} was written.\n", file.string());
  return text;
}

}  // namespace sparsha::app
