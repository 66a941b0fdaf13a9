// Formats lengths and counts, and the summary of a build.
#include "app/words/results.h"
#include "base/text/text.h"
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sparsha::app {

namespace {

const char* places_of(pipeline::CheckResult::Against against) {
  using Against = pipeline::CheckResult::Against;
  if (against == Against::points) return "points";
  return against == Against::mesh ? "places on the mesh" : "points and places on the mesh";
}

// The share of places below which it is no news that some are sparse.
constexpr double kFewSparse = 0.005;

std::string surface_line(const pipeline::Report::Surface& surface) {
  std::string text = fmt::format("surface   decided by {}", surface.method);
  if (surface.sparse_share >= kFewSparse)
    text +=
        fmt::format(", {} {:.1f} % of its places{}", surface.method == "windows" ? "since" : "wider at",
                    100.0 * surface.sparse_share,
                    surface.method == "windows" ? " are too sparse for tangent discs" : ", whose points are sparse");
  return text + '\n';
}

std::string around_line(const pipeline::AroundReport& around) {
  std::string text = fmt::format("around    {} sheets with {} nodes, {} apart", around.sheets, count_text(around.nodes),
                                 length_text(around.spacing_m));
  if (around.check && around.check->cloud_to_surface.samples > 0) {
    const pipeline::DistanceStatistics& cloud = around.check->cloud_to_surface;
    text += fmt::format("; {} points to them: median {}, 99 % within {}; {} far from all", count_text(cloud.samples),
                        length_text(cloud.median_m), length_text(cloud.p99_m), count_text(around.check->far));
  }
  return text + '\n';
}

}  // namespace

std::string build_summary(const scene::Scene& scene, const pipeline::Report& report,
                          const std::filesystem::path& folder) {
  const scene::SceneDescription& description = scene.description();
  const scene::Lattice& base = description.levels.front();
  std::string text;
  text += fmt::format("size      {} x {} x {}\n", length_text((base.nx - 1) * base.spacing_m),
                      length_text((base.ny - 1) * base.spacing_m),
                      length_text(description.height_max_m - description.height_min_m));
  text += fmt::format("grid      {} x {} nodes, {} apart, {} level{}\n", base.nx, base.ny, length_text(base.spacing_m),
                      description.levels.size(), description.levels.size() == 1 ? "" : "s");
  const auto& points = report.points;
  if (report.triangles > 0) text += fmt::format("mesh      {} triangles\n", count_text(report.triangles));
  const std::string edge_on =
      points.edge_on > 0 ? fmt::format(" ({} of them seen edge-on)", count_text(points.edge_on)) : "";
  text += fmt::format("points    {} read: {} used, {} occluded{}, {} outliers, {} outside, {} filtered, {} invalid\n",
                      count_text(points.read), count_text(points.used), count_text(points.occluded), edge_on,
                      count_text(points.outlier), count_text(points.outside), count_text(points.filtered),
                      count_text(points.invalid));
  if (points.scattered > 0) {
    text += fmt::format("scattered {} of these lie in space, no nearer to others than by chance, and make no surface\n",
                        count_text(points.scattered));
  }
  if (!report.surface.method.empty()) text += surface_line(report.surface);
  for (const pipeline::Report::Filter& filter : report.filters) {
    text += fmt::format("filter    {}: {} taken away{}{}\n", filter.name, count_text(filter.removed),
                        filter.outliers ? " as outliers" : "", filter.found.empty() ? "" : "; " + filter.found);
  }
  if (!report.orientation.empty()) text += "face      " + report.orientation + '\n';
  text += fmt::format("coverage  {:.1f} % of the nodes measured, {:.1f} % filled", 100.0 * report.coverage,
                      100.0 * report.filled_fraction);
  // A mesh has none.
  if (description.noise_m > 0.0) text += "; noise " + length_text(description.noise_m);
  text += '\n';
  if (report.check) {
    const auto& cloud = report.check->cloud_to_surface;
    text += cloud.samples == 0
                ? std::string("check     nothing to compare\n")
                : fmt::format("check     {} {} to surface: median {}, RMS {}, 99 % within {}\n",
                              count_text(cloud.samples), places_of(report.check->against), length_text(cloud.median_m),
                              length_text(cloud.rms_m), length_text(cloud.p99_m));
  }
  if (report.around) text += around_line(*report.around);
  text += fmt::format("time      {:.2f} s, {} MB at most\n", report.total_seconds, report.peak_rss_bytes / 1000000U);
  text += fmt::format("scene     {}\n", folder.string());
  for (const std::string& warning : report.warnings) text += "warning   " + warning + '\n';
  return text;
}

}  // namespace sparsha::app
