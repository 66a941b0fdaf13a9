// Units and signs are whole words here, there are no columns, and each value has its verb.
#include "app/words/sentences.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "base/text/text.h"
#include "scene/scene.h"

namespace sparsha::app {

std::string counted(std::uint64_t count, const char* one, const char* several) {
  return fmt::format("{} {}", count, count == 1 ? one : several);
}

std::string percent(double share) { return value_text(100.0 * share, 3) + " percent"; }

std::string exact_length(double metres) {
  if (std::isfinite(metres) && std::abs(metres) < 1e-4) return value_text(1e6 * metres, 3) + " micrometres";
  if (std::isfinite(metres) && std::abs(metres) < 0.1) return value_text(1e3 * metres, 3) + " millimetres";
  if (std::isfinite(metres) && std::abs(metres) < 2.0) return value_text(1e2 * metres, 3) + " centimetres";
  return value_text(metres, 4) + " metres";
}

namespace {

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

}  // namespace

std::string summary_sentences(const haptics::SessionSummary& s, std::uint64_t strikes) {
  std::string text =
      fmt::format("The run took {:.1f} seconds; the stone was touched for {:.1f} seconds of them, in {}.\n",
                  s.duration_s, s.contact_s, counted(s.contacts, "contact", "contacts"));
  text += fmt::format("{} heard.\n", strikes == 1 ? "1 strike was" : fmt::format("{} strikes were", strikes));
  text += fmt::format("The hand went {}.\n", exact_length(s.path_m));
  if (s.contacts > 0)
    text += fmt::format("In contact it felt {:.2f} newtons on average and {:.2f} newtons at most.\n", s.mean_force_n,
                        s.peak_force_n);
  text += fmt::format("It explored {} square centimetres of the scene.\n", value_text(s.area_m2 * 1e4, 3));
  text +=
      fmt::format("The servo made {}; {} of them came in time, and {} left out.\n", counted(s.ticks, "tick", "ticks"),
                  percent(s.share_in_time), s.missed_ticks == 1 ? "1 was" : fmt::format("{} were", s.missed_ticks));
  if (!s.real_time) text += "No real-time priority was granted.\n";
  if (s.faults > 0) text += fmt::format("The force was taken away in {}.\n", counted(s.faults, "fault", "faults"));
  if (s.dropped_records > 0)
    text += fmt::format("The recording lacks {}.\n", counted(s.dropped_records, "row", "rows"));
  return text;
}

std::string build_sentences(const scene::Scene& scene, const pipeline::Report& report,
                            const std::filesystem::path& folder) {
  const scene::SceneDescription& description = scene.description();
  const scene::Lattice& base = description.levels.front();
  std::string text = fmt::format(
      "The scene is {} wide, {} high and {} deep.\n", exact_length((base.nx - 1) * base.spacing_m),
      exact_length((base.ny - 1) * base.spacing_m), exact_length(description.height_max_m - description.height_min_m));
  text += fmt::format("Its grid has {} times {} nodes, {} apart, in {}.\n", base.nx, base.ny,
                      exact_length(base.spacing_m), counted(description.levels.size(), "level", "levels"));
  if (report.triangles > 0) text += fmt::format("A mesh has {}.\n", counted(report.triangles, "triangle", "triangles"));
  text += fmt::format("{} were read, and {} of them were used.\n", counted(report.points.read, "point", "points"),
                      report.points.used);
  text += fmt::format("{} of the nodes were measured, and {} were filled.\n", capital(percent(report.coverage)),
                      percent(report.filled_fraction));
  if (report.check && report.check->cloud_to_surface.samples > 0) {
    const auto& cloud = report.check->cloud_to_surface;
    text += fmt::format("{} within {} of the surface, and 99 percent within {}.\n",
                        capital(pipeline::half_of(report.check->against)), exact_length(cloud.median_m),
                        exact_length(cloud.p99_m));
  }
  if (report.around) {
    text += fmt::format("All sides together have {} with {}.\n", counted(report.around->sheets, "sheet", "sheets"),
                        counted(report.around->nodes, "node", "nodes"));
    if (report.around->check && report.around->check->cloud_to_surface.samples > 0) {
      const auto& cloud = report.around->check->cloud_to_surface;
      text += fmt::format("Half of the points lie within {} of a sheet, and 99 percent within {}.\n",
                          exact_length(cloud.median_m), exact_length(cloud.p99_m));
    }
  }
  text += fmt::format("Building took {:.1f} seconds.\n", report.total_seconds);
  text += fmt::format("The scene is in the folder {} and its report in {}.\n", folder.string(),
                      (folder / "report.html").string());
  for (const std::string& warning : report.warnings) text += fmt::format("There is a warning: {}.\n", warning);
  return text;
}

std::string progress_sentence(const std::string& stage, double fraction, double left_s) {
  std::string text = fmt::format("The step {} is {:.0f} percent done", stage, 100.0 * fraction);
  if (left_s >= 1.0) {
    const double seconds = std::round(left_s);
    text +=
        seconds == 1.0 ? ", and about 1 second is left" : fmt::format(", and about {:.0f} seconds are left", seconds);
  }
  return text + ".";
}

}  // namespace sparsha::app
