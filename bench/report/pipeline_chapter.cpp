// From points to heights, ours and other people's.
#include <map>
#include <utility>

#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"

namespace sparsha::bench {
namespace {

const std::vector<Column> kOpenColumns = {{"method", "method"},
                                          {"points_per_node", "points per node"},
                                          {"noise_mm", "noise, mm"},
                                          {"spacing_ratio", "node spacing / point spacing"},
                                          {"points", "points"},
                                          {"nodes", "nodes"},
                                          {"seconds", "time, ms", 1e3},
                                          {"ratio", "time over ours"},
                                          {"ratio_low", "least"},
                                          {"ratio_high", "greatest"},
                                          {"rms_away_mm", "RMS, mm"},
                                          {"p99_away_mm", "99 %, mm"},
                                          {"wrong_layer_percent", "wrong layer, %"},
                                          {"completeness_percent", "complete, %"}};
const std::vector<Column> kClosedColumns = {{"method", "method"},
                                            {"object", "object"},
                                            {"points", "points"},
                                            {"noise_spacings", "noise, spacings"},
                                            {"spacing_ratio", "node spacing / point spacing"},
                                            {"seconds", "time, ms", 1e3},
                                            {"ratio", "time over ours"},
                                            {"ratio_low", "least"},
                                            {"ratio_high", "greatest"},
                                            {"rms_spacings", "RMS, spacings"},
                                            {"p99_spacings", "99 %, spacings"},
                                            {"median_spacings", "median where smooth, spacings"},
                                            {"wrong_layer_percent", "wrong layer, %"},
                                            {"beyond_percent", "beyond the silhouette, %"},
                                            {"completeness_percent", "complete, %"}};

/// One table for each value of `column` in turn, folded unless it is "base".
std::string by_varied(const Table& table, const std::vector<Column>& columns, const std::string& first,
                      const std::map<std::string, std::string>& titles) {
  std::string html;
  for (const auto& [value, title] : titles)
    for (std::size_t begin = 0; begin < table.rows.size(); ++begin) {
      const std::string group = table.text(begin, first);
      bool seen = false;
      for (std::size_t row = 0; row < begin; ++row) seen = seen || table.text(row, first) == group;
      if (seen) continue;
      const std::string caption = title + ": " + group;
      const std::string part = html_of(table, caption, columns, [&, v = value](std::size_t row) {
        return table.text(row, first) == group && table.text(row, "varied") == v;
      });
      html += part.empty() || value == "base" ? part : html_folded(caption, part);
    }
  return html;
}

std::string peers_html(const std::filesystem::path& folder) {
  std::string html;
  if (const auto open = read_table(folder / "pipeline_open_peers.csv"))
    html +=
        html_heading("Pipeline: open objects") +
        "<p>A relief of 1 m with grooves, a step of 10 mm, 0.5 % of outliers and a back: sparse (a tenth of the "
        "front's density, 100 mm behind) or as dense as the front (60 mm behind). Every method gets the same points "
        "and gives heights on the same lattice, on one thread, in turns; each is judged by the analytic surface. "
        "RMS and 99 % count nodes farther than three spacings from the step; <em>wrong layer</em>: more than 5 mm "
        "off; <em>complete</em>: share of the nodes that have a height. <em>Least</em> and <em>greatest</em> are "
        "those of the ratios in the same round. PCL's moving least squares (order 2, radius three point spacings) "
        "smooths the points, then a raster takes them. CloudCompare is timed as a process, with reading and "
        "writing.</p>" +
        by_varied(
            *open, kOpenColumns, "back",
            {{"base", "Back"}, {"density", "Density, back"}, {"noise", "Noise, back"}, {"spacing", "Spacing, back"}});
  if (const auto closed = read_table(folder / "pipeline_closed_peers.csv"))
    html += html_heading("Pipeline: closed objects") +
            "<p>Raw points of whole objects, uniform by area, no faces: what is seen first from above is wanted, and "
            "the back is as dense as the front. Errors in mean point spacings against the traced surface; <em>wrong "
            "layer</em>: more than three spacings off; <em>complete</em>: share of the nodes in the silhouette that "
            "have a height, where the lattice is known.</p>" +
            by_varied(*closed, kClosedColumns, "object",
                      {{"base", "Object"}, {"density", "Density"}, {"noise", "Noise"}, {"spacing", "Spacing"}});
  if (!html.empty())
    html +=
        "<p>Where a peer is better: a z-buffer, a mean and a median take a small part of our time, and inverse "
        "distance "
        "leaves fewer nodes empty. No object here is one layer without a back, where all of them do better than in "
        "these "
        "tables. None of them knows what lies behind what; CloudCompare's SOR takes a sparse back away and not one as "
        "dense as the front.</p>";
  return html;
}

/// The tables of some files, one below the other.
class Tables {
 public:
  explicit Tables(const std::filesystem::path& folder) : folder_(folder) {}
  /// Nothing where the file is missing.
  void add(const char* file, const char* caption, const std::vector<Column>& columns, bool folded) {
    const std::string table = html_of(folder_ / file, caption, columns);
    if (!table.empty()) html_ += folded ? html_folded(caption, table) : table;
  }
  [[nodiscard]] const std::string& html() const { return html_; }

 private:
  const std::filesystem::path& folder_;
  std::string html_;
};

std::string steps_html(const std::filesystem::path& folder) {
  Tables tables(folder);
  tables.add("pipeline_formats.csv", "Readers of each format, processor time, beside reading the bytes alone",
             {{"format", "format"},
              {"file", "file"},
              {"points", "points"},
              {"megabytes", "MB"},
              {"points_per_s", "M points/s", 1e-6},
              {"megabytes_per_s", "MB/s"},
              {"cat_megabytes_per_s", "bytes alone, MB/s"}},
             false);
  tables.add("pipeline_filters.csv", "Outliers, voxels and other filters, ours and PCL's",
             {{"filter", "filter"},
              {"method", "method"},
              {"threads", "threads"},
              {"points", "points"},
              {"median_s", "median, ms", 1e3},
              {"longest_s", "longest, ms", 1e3},
              {"ratio", "time over ours on one thread"},
              {"ratio_low", "least"},
              {"ratio_high", "greatest"},
              {"rounds", "rounds"},
              {"agreement", "results, ours on one thread and PCL's"}},
             false);
  tables.add("pipeline_normals.csv", "Normals through 14 neighbours, our tangent discs and PCL's",
             {{"object", "object"},
              {"points", "points"},
              {"noise_spacings", "noise, spacings"},
              {"method", "method"},
              {"threads", "threads"},
              {"median_s", "median, s"},
              {"longest_s", "longest, s"},
              {"ratio", "time over ours"},
              {"ratio_low", "least"},
              {"ratio_high", "greatest"},
              {"rounds", "rounds"},
              {"median_deg", "median error, °"},
              {"p95_deg", "95 %, °"}},
             true);
  tables.add("pipeline_registration.csv", "Registration from 5° and 10 mm off, ours and PCL's plain ICP",
             {{"scans", "scans"},
              {"method", "method"},
              {"seed", "seed"},
              {"median_s", "median, s"},
              {"longest_s", "longest, s"},
              {"ratio", "time over our GICP's"},
              {"ratio_low", "least"},
              {"ratio_high", "greatest"},
              {"rounds", "rounds"},
              {"rms_mm", "RMS, mm"}},
             false);
  return tables.html();
}

std::string builds_html(const std::filesystem::path& folder) {
  Tables tables(folder);
  tables.add("pipeline_accuracy.csv", "Accuracy of every scene",
             {{"scene", "scene"},
              {"method", "method"},
              {"points", "points"},
              {"coverage_percent", "measured, %"},
              {"rms_away_mm", "RMS away from steps, mm"},
              {"p99_away_mm", "99 %, mm"},
              {"off_2mm_away_percent", "&gt; 2 mm, %"},
              {"rms_smooth_mm", "RMS where smooth, mm"},
              {"median_mm", "median, mm"},
              {"seconds", "time, s"}},
             true);
  tables.add("pipeline_closed.csv", "Closed objects by density, hole and noise, with CloudCompare",
             {{"object", "object"},
              {"method", "method"},
              {"points", "points"},
              {"noise_spacings", "noise, spacings"},
              {"density_ratio", "density"},
              {"hole_spacings", "hole"},
              {"lines", "lines 1:"},
              {"wrong_smooth_percent", "wrong, smooth, %"},
              {"wrong_percent", "wrong, %"},
              {"beyond_percent", "beyond, %"},
              {"median_spacings", "median, spacings"},
              {"ms_one_thread", "1 thread, ms"},
              {"ms_two_threads", "2 threads, ms"}},
             true);
  tables.add("pipeline_mtf.csv", "Gain and coherence by wavelength",
             {{"scene", "scene"},
              {"wavelength_from_nodes", "from, nodes"},
              {"wavelength_to_nodes", "to, nodes"},
              {"gain", "gain"},
              {"coherence", "coherence"}},
             true);
  tables.add("pipeline_c2m.csv", "Distances from scan to surface, ours and CloudCompare's",
             {{"method", "method"}, {"points", "points"}, {"mean_mm", "mean, mm"}, {"rms_mm", "RMS, mm"}}, false);
  tables.add("pipeline_speed.csv", "Projection and whole builds: time, memory, error",
             {{"task", "task"},
              {"method", "method"},
              {"threads", "threads"},
              {"points", "points"},
              {"nodes", "nodes"},
              {"seconds", "time, s"},
              {"cpu_seconds", "CPU, s"},
              {"peak_rss_mb", "memory, MB"},
              {"rms_away_mm", "RMS, mm"}},
             false);
  return tables.html();
}

}  // namespace

std::string pipeline_html(const std::filesystem::path& folder) {
  std::string html = peers_html(folder);
  if (const std::string steps = steps_html(folder); !steps.empty())
    html += html_heading("Pipeline: readers, filters, normals and registration") + steps;
  if (const std::string builds = builds_html(folder); !builds.empty())
    html += html_heading("Pipeline: accuracy by scene and whole builds") +
            "<p>Simulated scans with a known truth, read as files (docs/measure/accuracy.md).</p>" + builds;
  return html;
}

}  // namespace sparsha::bench
