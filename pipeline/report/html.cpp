// Written for a curator first: what was scanned, how big, how well; then the pictures; then everything a specialist
// asks.
#include "pipeline/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/text/base64.h"
#include "base/text/html.h"
#include "base/text/text.h"
#include "pipeline/report/page.h"
#include "pipeline/report/scan_graph.h"
#include "pipeline/report/svg.h"
#include "scene/folder/layer_file.h"
#include "scene/scene.h"
#include "scene/title.h"

namespace sparsha::pipeline {
namespace {

std::string percent(double fraction) {
  if (!std::isfinite(fraction)) return "unknown";
  // Neither must 99.97 % read as 100 % nor 0.03 % as 0 %.
  const double value = 100 * fraction;
  const bool near_all = value > 99.9 && value<100, near_none = value> 0 && value < 0.1;
  if (near_none && value < 0.01) return "under 0.01\u202F%";
  return fmt::format("{:.{}f}\u202F%", near_all ? std::floor(value * 100) / 100 : value, near_all || near_none ? 2 : 1);
}

std::string size_text(const scene::SceneDescription& scene) {
  if (scene.levels.empty()) return "unknown";
  const scene::Lattice& l = scene.levels.front();
  return fmt::format("{} wide, {} tall, {} deep", length_text((l.nx - 1) * l.spacing_m, TextStyle::typeset),
                     length_text((l.ny - 1) * l.spacing_m, TextStyle::typeset),
                     length_text(scene.height_max_m - scene.height_min_m, TextStyle::typeset));
}

/// The beginning of a sentence.
std::string half_words(CheckResult::Against against) {
  std::string text = half_of(against);
  text.front() = 'H';
  return text;
}

/// One sentence in plain words.
std::string lead(const scene::SceneDescription& scene, const Report& report) {
  const std::string points = count_text(report.points.read, TextStyle::typeset);
  const std::string triangles = count_text(report.triangles, TextStyle::typeset);
  std::string text = fmt::format("A surface {}, from ", size_text(scene));
  text += report.triangles == 0
              ? points + " points."
              : fmt::format("a mesh of {} triangles; {} corners and points in all.", triangles, points);
  text += fmt::format(" {} of the picture is measured", percent(report.coverage));
  if (report.filled_fraction > 0)
    text += fmt::format(" and {} filled across small gaps", percent(report.filled_fraction));
  text += ".";
  if (report.check && report.check->cloud_to_surface.samples > 0)
    text += fmt::format(" {} within {} of this surface, 95\u202F% within {}.", half_words(report.check->against),
                        length_text(report.check->cloud_to_surface.median_m, TextStyle::typeset),
                        length_text(report.check->cloud_to_surface.p95_m, TextStyle::typeset));
  return text;
}

const char* to_surface_title(CheckResult::Against against) {
  if (against == CheckResult::Against::points) return "Points to surface";
  return against == CheckResult::Against::mesh ? "Mesh to surface" : "Mesh and points to surface";
}

const char* nearest_words(CheckResult::Against against) {
  if (against == CheckResult::Against::points) return "a point";
  return against == CheckResult::Against::mesh ? "a triangle" : "a triangle or point";
}

std::string key_figures(const scene::SceneDescription& scene, const Report& report) {
  std::string html = "<dl class='figures'>";
  const auto add = [&](const char* name, const std::string& value, const std::string& note) {
    html += fmt::format("<div><dt>{}</dt><dd>{}{}</dd></div>", name, value,
                        note.empty() ? "" : fmt::format(" <small>{}</small>", note));
  };
  if (!scene.levels.empty()) {
    const scene::Lattice& l = scene.levels.front();
    add("Size",
        fmt::format("{} \u00D7 {}", length_text((l.nx - 1) * l.spacing_m, TextStyle::typeset),
                    length_text((l.ny - 1) * l.spacing_m, TextStyle::typeset)),
        fmt::format("depth {}", length_text(scene.height_max_m - scene.height_min_m, TextStyle::typeset)));
    add("Resolution", length_text(l.spacing_m, TextStyle::typeset), fmt::format("{} \u00D7 {} nodes", l.nx, l.ny));
  }
  add("Coverage", percent(report.coverage), fmt::format("{} filled", percent(report.filled_fraction)));
  if (scene.noise_m > 0)
    add("Scanner noise", length_text(scene.noise_m, TextStyle::typeset),
        scene.config.grid.noise_m ? "standard deviation, from grid.noise_mm" : "standard deviation, estimated");
  if (!report.surface.method.empty())
    add("Surface decided by", report.surface.method,
        report.surface.sparse_share > 0.0
            ? fmt::format("{} of its places are sparse", percent(report.surface.sparse_share))
            : "");
  if (report.check) {
    const CheckResult& check = *report.check;
    if (check.cloud_to_surface.samples > 0)
      add(to_surface_title(check.against), length_text(check.cloud_to_surface.median_m, TextStyle::typeset),
          fmt::format("median; 95\u202F% within {}", length_text(check.cloud_to_surface.p95_m, TextStyle::typeset)));
    if (check.completeness)
      add("Completeness", percent(*check.completeness),
          fmt::format("of the outline has {} within {}", nearest_words(check.against),
                      length_text(check.tolerance_m, TextStyle::typeset)));
  }
  if (report.friction && report.friction->undecided > 0 && scene.config.friction) {
    const auto& [nodes, undecided] = *report.friction;
    add("Friction not told", percent(static_cast<double>(undecided) / static_cast<double>(nodes)),
        fmt::format("{} nodes with too little of their own surface around them take the coefficient {:.2g}",
                    count_text(undecided, TextStyle::typeset), scene.config.friction->mu_0));
  }
  const scene::HapticsConfig& haptics = scene.config.haptics;
  if (haptics.impact || haptics.grain)
    add("Invented",
        haptics.impact && haptics.grain ? "ring of strikes, fine grain"
                                        : (haptics.impact ? "ring of strikes" : "fine grain"),
        "is felt, was not measured");
  return html + "</dl>";
}

std::string warnings(const Report& report) {
  if (report.warnings.empty()) return "<p>There are no warnings.</p>";
  std::string html = "<div class='warnings' role='note' aria-label='Warnings'><ul>";
  for (const std::string& text : report.warnings) html += fmt::format("<li>{}</li>", escape_html(text));
  return html + "</ul></div>";
}

/// Appends, because the pictures are most of the page.
void add_figure(std::string& html, const Picture& picture, const std::string& png, double width_m, bool wide) {
  html += fmt::format("<figure class='{}{}'><div class='picture'><img src='data:image/png;base64,", wide ? "wide" : "",
                      picture.width < 400 ? " tiny" : "");
  html += to_base64(png);
  html += fmt::format(
      "' width='{}' height='{}' alt='{}'>{}</div>{}<figcaption><h3>{}</h3><p>{}</p></figcaption></figure>\n",
      picture.width, picture.height, escape_html(picture.alternative), scale_bar_html(width_m), legend_svg(picture),
      escape_html(picture.title), escape_html(picture.caption));
}

std::string points_table(const Report& report) {
  const Report::Points& p = report.points;
  std::string html = fmt::format("<table><caption>What became of the points{}</caption>",
                                 report.triangles > 0 ? ", corners of triangles among them" : "");
  html +=
      "<thead><tr><th scope='col' class='text'>Points</th>"
      "<th scope='col'>Count</th><th scope='col'>Share</th></tr></thead><tbody>";
  const auto row = [&](const char* name, std::uint64_t count) {
    html += fmt::format("<tr><th scope='row'>{}</th><td>{}</td><td>{}</td></tr>", name,
                        count_text(count, TextStyle::typeset),
                        p.read > 0 ? percent(static_cast<double>(count) / static_cast<double>(p.read)) : "\u2013");
  };
  row("read", p.read);
  row("used for the surface", p.used);
  row("not visible from here: behind the surface", p.occluded - p.edge_on);
  if (p.edge_on > 0) row("not visible from here: on surfaces seen edge-on", p.edge_on);
  row("outliers", p.outlier);
  row("outside the grid", p.outside);
  if (p.scattered > 0) row("scattered in space, of those above: they make no surface", p.scattered);
  row("taken away by filters", p.filtered);
  row("invalid in the file", p.invalid);
  return html + "</tbody></table>";
}

std::string filters_table(const Report& report) {
  if (report.filters.empty()) return {};
  std::string html =
      "<div class='scroll' tabindex='0' role='region' aria-label='Table of filters'><table><caption>What the filters "
      "took "
      "away, in their order</caption><thead><tr><th scope='col' class='text'>Filter</th><th scope='col'>Points</th><th "
      "scope='col'>Share</th><th scope='col' class='text'>What it found</th></tr></thead><tbody>";
  for (const Report::Filter& filter : report.filters) {
    const double share =
        report.points.read > 0 ? static_cast<double>(filter.removed) / static_cast<double>(report.points.read) : 0.0;
    html += fmt::format("<tr><th scope='row'><code>{}</code></th><td>{}</td><td>{}</td><td class='text'>{}{}</td></tr>",
                        filter.name, count_text(filter.removed, TextStyle::typeset), percent(share),
                        escape_html(filter.found),
                        filter.outliers ? std::string(filter.found.empty() ? "" : "; ") + "counted as outliers" : "");
  }
  html += "</tbody></table></div>";
  const bool moved = std::any_of(report.filters.begin(), report.filters.end(),
                                 [](const Report::Filter& filter) { return filter.name == "smooth"; });
  if (moved) {
    html +=
        "<p>The filter <code>smooth</code> moved the points that the surface was fitted to. All distances in this "
        "report "
        "are measured from the points as they were scanned.</p>";
  }
  return html;
}

// One row a figure, so that the table fits a narrow page.
std::string distances_table(const CheckResult& check) {
  const DistanceStatistics& to_surface = check.cloud_to_surface;
  const DistanceStatistics& to_cloud = check.surface_to_cloud;
  std::string html = fmt::format(
      "<div class='scroll' tabindex='0' role='region' aria-label='Table of distances'><table><caption>Unsigned "
      "distances; the signed mean is positive towards the viewer</caption><thead><tr><th scope='col' class='text'>"
      "Distances</th><th scope='col'>from {0} to the surface</th><th scope='col'>from surface nodes to {0}</th></tr>"
      "</thead><tbody>",
      words_of(check.against));
  const auto row = [&](const char* name, const auto& text) {
    const auto cell = [&](const DistanceStatistics& s) { return s.samples == 0 ? "\u2013" : text(s); };
    html +=
        fmt::format("<tr><th scope='row'>{}</th><td>{}</td><td>{}</td></tr>", name, cell(to_surface), cell(to_cloud));
  };
  const auto length_row = [&](const char* name, double DistanceStatistics::*figure) {
    row(name, [figure](const DistanceStatistics& s) { return length_text(s.*figure, TextStyle::typeset); });
  };
  row("samples", [](const DistanceStatistics& s) { return count_text(s.samples, TextStyle::typeset); });
  row("mean", [](const DistanceStatistics& s) {
    return length_text(s.mean_m, TextStyle::typeset) +
           (s.mean_ci95_m > 0 ? fmt::format(" \u00B1 {}", length_text(s.mean_ci95_m, TextStyle::typeset)) : "");
  });
  length_row("RMS", &DistanceStatistics::rms_m);
  length_row("median", &DistanceStatistics::median_m);
  length_row("MAD", &DistanceStatistics::mad_m);
  length_row("95\u202F% within", &DistanceStatistics::p95_m);
  length_row("99\u202F% within", &DistanceStatistics::p99_m);
  length_row("largest", &DistanceStatistics::max_m);
  length_row("signed mean", &DistanceStatistics::signed_mean_m);
  return html + "</tbody></table></div>";
}

std::string histogram(const std::string& title, const std::vector<std::uint64_t>& counts, double bin_m,
                      const DistanceStatistics& s) {
  if (s.samples == 0) return {};
  std::uint64_t shown = 0;
  for (const std::uint64_t count : counts) shown += count;
  const std::string summary = fmt::format(
      "Histogram, {}: median {}, 95 % within {}, 99 % within {}.", title, length_text(s.median_m, TextStyle::typeset),
      length_text(s.p95_m, TextStyle::typeset), length_text(s.p99_m, TextStyle::typeset));
  std::string html = fmt::format(
      "<div><h3>{}</h3>{}<p>{} of {} distances are shown; {} lie beyond the right end.</p><details><summary>The "
      "histogram as a table</summary><table><caption>Distances, counted by range</caption><thead><tr><th "
      "scope='col'>From</th><th scope='col'>To</th><th "
      "scope='col'>Count</th>"
      "</tr></thead><tbody>",
      title,
      histogram_svg(counts, bin_m,
                    {{s.median_m, "median " + length_text(s.median_m, TextStyle::typeset)},
                     {s.p95_m, "95 % " + length_text(s.p95_m, TextStyle::typeset)}},
                    summary),
      count_text(shown, TextStyle::typeset), count_text(s.samples, TextStyle::typeset),
      count_text(s.samples - shown, TextStyle::typeset));
  constexpr std::size_t kBinsPerRow = 4;
  for (std::size_t k = 0; k < counts.size(); k += kBinsPerRow) {
    std::uint64_t count = 0;
    const std::size_t end = std::min(counts.size(), k + kBinsPerRow);
    for (std::size_t n = k; n < end; ++n) count += counts[n];
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td></tr>", length_text(static_cast<double>(k) * bin_m, TextStyle::typeset),
        length_text(static_cast<double>(end) * bin_m, TextStyle::typeset), count_text(count, TextStyle::typeset));
  }
  return html + "</tbody></table></details></div>";
}

std::string difference_text(double metres) {
  constexpr double kNanometre = 1e-9;
  return metres < kNanometre ? "less than a nanometre" : "at most " + length_text(metres, TextStyle::typeset);
}

std::string accuracy(const Report& report) {
  if (!report.check) return "<p>No cross-check was asked for (the configuration has no <code>check</code> block).</p>";
  const CheckResult& check = *report.check;
  std::string html = fmt::format("<p>The surface was compared with {} in both directions, by exact nearest distances.",
                                 words_of(check.against));
  if (check.against != CheckResult::Against::points)
    html +=
        " A mesh is judged by its triangles: places spread evenly over what the view shows of them, and for each node "
        "the nearest triangle.";
  if (check.second_method_samples > 0)
    html += fmt::format(" A second method measured {} of the distances again and differs by {}.",
                        count_text(check.second_method_samples, TextStyle::typeset),
                        difference_text(check.second_method_max_difference_m));
  if (check.cloud_to_surface.mean_ci95_m > 0)
    html += " The figures come from a random sample; \u00B1 is the 95\u202F% confidence interval of the mean.";
  html += "</p>" + distances_table(check) + "<div class='columns'>";
  const std::string against = words_of(check.against);
  html += histogram("From " + against + " to the surface", check.cloud_histogram, check.histogram_bin_m,
                    check.cloud_to_surface);
  html += histogram("From surface nodes to " + against, check.surface_histogram, check.surface_histogram_bin_m,
                    check.surface_to_cloud);
  return html + "</div>";
}

/// The whole object's sheets, and what their check found.
std::string whole_object(const AroundReport& around) {
  std::string html = "<table><caption>The whole object, all sides</caption><tbody>";
  const auto row = [&](const char* name, const std::string& text) {
    html += fmt::format("<tr><th scope='row'>{}</th><td>{}</td></tr>", name, text);
  };
  const auto length = [](double metres) { return length_text(metres, TextStyle::typeset); };
  const auto count = [](std::uint64_t number) { return count_text(number, TextStyle::typeset); };
  row("sheets", count(around.sheets));
  row("nodes", fmt::format("{}, {} apart", count(around.nodes), length(around.spacing_m)));
  row("points whose outer side nothing tells", count(around.undecided));
  row("points of walls whose two faces mix", count(around.thin));
  if (around.mixed_share > 0.0)
    row("walls whose two faces are taken for one",
        fmt::format("{:.2g}\u202F% of the surface", 100.0 * around.mixed_share));
  if (around.check) {
    const ChartCheck& check = *around.check;
    row("points that were compared", fmt::format("{} of {}", count(check.sampled), count(check.points)));
    row("points far from every sheet",
        fmt::format("{}, more than {:.0f} nodes", count(check.far), ChartCheck::kFarSpacings));
    const auto distances = [&](const char* name, const DistanceStatistics& s) {
      if (s.samples == 0) return;
      row(name, fmt::format("median {}, 99\u202F% within {}", length(s.median_m), length(s.p99_m)));
    };
    distances("from points to the sheets", check.cloud_to_surface);
    distances("between sheets of two sides", check.agreement);
    row("nodes that one side alone has",
        fmt::format("{} of {} looked at", count(check.nodes_alone), count(check.nodes)));
    const SidesCheck& sides = check.sides;
    row("nodes that face what the points enclose",
        fmt::format("{} of {} whose side the points tell", count(sides.inwards), count(sides.told)));
    for (const SidesCheck::Place& place : sides.places) {
      row("of them, between",
          fmt::format("({:.4g}, {:.4g}, {:.4g}) and ({:.4g}, {:.4g}, {:.4g}) m of the scans: {} nodes", place.min_m.x(),
                      place.min_m.y(), place.min_m.z(), place.max_m.x(), place.max_m.y(), place.max_m.z(),
                      count(place.nodes)));
    }
  }
  return html + "</tbody></table>";
}

std::string inputs(const scene::SceneDescription& scene) {
  std::string html =
      "<div class='scroll' tabindex='0' role='region' aria-label='Table of input files'><table><caption>Scan files and "
      "their "
      "fingerprints</caption><thead><tr><th scope='col' class='text'>File</th><th scope='col'>Points</th>"
      "<th scope='col' class='text'>SHA-256</th></tr></thead><tbody>";
  for (const scene::ScanSource& source : scene.sources)
    html += fmt::format("<tr><th scope='row'>{}</th><td>{}</td><td class='text'><code class='hash'>{}</code></td></tr>",
                        escape_html(source.file.generic_string()), count_text(source.points, TextStyle::typeset),
                        escape_html(source.sha256));
  return html + "</tbody></table></div>";
}

std::string grid_table(const scene::SceneDescription& scene) {
  std::string html =
      "<table><caption>Levels of detail</caption><thead><tr><th scope='col'>Level</th><th scope='col'>Nodes</th>"
      "<th scope='col'>Spacing</th></tr></thead><tbody>";
  for (std::size_t k = 0; k < scene.levels.size(); ++k)
    html += fmt::format("<tr><th scope='row'>{}</th><td>{} \u00D7 {}</td><td>{}</td></tr>", k, scene.levels[k].nx,
                        scene.levels[k].ny, length_text(scene.levels[k].spacing_m, TextStyle::typeset));
  html += "</tbody></table>";
  if (!scene.levels.empty()) {
    const Eigen::Vector3d& o = scene.levels.front().origin_m;
    html += fmt::format("<p>{} Origin of the grid: x {:.4f}\u202Fm, y {:.4f}\u202Fm, z {:.4f}\u202Fm.</p>",
                        scene::keeps_scan_axes(scene)
                            ? "The grid keeps the scan's own axes, so the layers' world files place them on its map."
                            : "The object is looked at from a direction of its own: the layers' world files hold local "
                              "coordinates, not the scan's.",
                        o.x(), o.y(), o.z());
  }
  return html;
}

std::string stages(const Report& report) {
  std::string html =
      "<table><caption>Time taken</caption><thead><tr><th scope='col' class='text'>Stage</th><th "
      "scope='col'>Seconds</th>"
      "</tr></thead><tbody>";
  for (const StageTime& stage : report.stages)
    html += fmt::format("<tr><th scope='row'>{}</th><td>{:.3f}</td></tr>", escape_html(stage.name), stage.seconds);
  html += fmt::format("<tr><th scope='row'>all, with writing</th><td>{:.3f}</td></tr></tbody></table>",
                      report.total_seconds);
  if (report.peak_rss_bytes > 0)
    html += fmt::format("<p>Peak memory: {:.0f}\u202FMB.</p>", static_cast<double>(report.peak_rss_bytes) / 1e6);
  return html;
}

constexpr const char* kWords = R"html(<dl class='words'>
<dt>Coverage</dt><dd>Share of the grid's nodes whose height was measured. Filled heights never count as measured.</dd>
<dt>Completeness</dt><dd>Share of the nodes inside the object's outline that have a raw point, or a triangle of a mesh, within the tolerance.</dd>
<dt>Points to surface, mesh to surface</dt><dd>Straight distance from each raw point to the modelled surface; outliers are included, points that are not visible from here are not. Of a mesh, from places spread evenly over what the view shows of its triangles.</dd>
<dt>RMS, MAD</dt><dd>Root of the mean square; median of the deviations from the median, which single outliers do not move.</dd>
<dt>Outliers</dt><dd>Points that stand alone before or behind the surface.</dd>
<dt>Not visible from here</dt><dd>Points of parts that this view hides, such as the back, and of surfaces that lie along the line of sight, such as the floor under a statue. They say nothing about the surface and are not judged.</dd>
<dt>Texture and friction</dt><dd>The fine relief on top of the smoothed form, and the resistance that a hand feels when it slides over it.</dd>
<dt>Invented</dt><dd>What a hand feels and no scan has measured: the ring of a strike, by the material named in the configuration, and grain finer than the scan resolves, which continues the statistics of the measured heights. No height and no figure of this report contains it.</dd>
</dl>)html";

}  // namespace

std::string report_html(const scene::Scene& scene, const Report& report, const std::vector<Picture>& pictures,
                        const std::vector<std::string>& encoded) {
  const scene::SceneDescription& description = scene.description();
  std::size_t size = 1U << 16;
  for (const std::string& png : encoded) size += png.size() * 4 / 3;
  const std::string known = scene::title_of(description);
  const std::string title = known.empty() ? "Untitled scan" : escape_html(known);
  std::string html;
  html.reserve(size);
  html += page_head(title, "Scan report", lead(description, report)) + "<nav aria-label='Sections'><ul>";
  const std::vector<std::pair<std::string, std::string>> sections = {
      {"pictures", "Pictures"},     {"accuracy", "Accuracy"},         {"points", "Points and grid"},
      {"inputs", "Inputs"},         {"words", "What the words mean"}, {"configuration", "Configuration"},
      {"making", "How it was made"}};
  for (const auto& [id, name] : sections) html += fmt::format("<li><a href='#{}'>{}</a></li>", id, name);
  html +=
      "</ul></nav>\n</header>\n<main id='main'>\n<section aria-labelledby='figures-h'><h2 id='figures-h'>At a "
      "glance</h2>";
  html += key_figures(description, report);
  if (!report.orientation.empty()) html += "<p>Front: " + escape_html(report.orientation) + ".</p>";
  html += "</section>\n<section aria-labelledby='warnings-h'><h2 id='warnings-h'>Warnings</h2>";
  html += warnings(report) + "</section>\n";
  const auto open = [&](std::size_t k) {
    html += fmt::format("<section id='{0}' aria-labelledby='{0}-h'><h2 id='{0}-h'>{1}</h2>", sections[k].first,
                        sections[k].second);
  };
  const auto section = [&](std::size_t k, const std::string& body) {
    open(k);
    html += body + "</section>\n";
  };
  open(0);
  html += "<div class='gallery'>\n";
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const scene::Lattice& lattice = description.levels.front();
    const double grid_m = pictures[k].width * nodes_per_pixel(lattice) * lattice.spacing_m;
    add_figure(html, pictures[k], encoded[k], pictures[k].width_m > 0 ? pictures[k].width_m : grid_m, k == 0);
  }
  html += "</div></section>\n";
  section(1, accuracy(report) + (report.around ? whole_object(*report.around) : std::string()));
  section(2, "<div class='columns'><div>" + points_table(report) + "</div><div>" + grid_table(description) +
                 "</div></div>" + filters_table(report));
  section(3, inputs(description) + scan_graph_html(report.pairs));
  section(4, kWords);
  section(5,
          "<p>Everything needed to build this scene again from its scans.</p><pre tabindex='0' role='region' "
          "aria-label='Configuration in YAML'><code>" +
              escape_html(scene::to_yaml(description.config)) + "</code></pre>");
  section(6, stages(report));
  html += page_end();
  return html;
}

}  // namespace sparsha::pipeline
