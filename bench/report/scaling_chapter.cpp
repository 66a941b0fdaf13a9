// How time grows with points and nodes.
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "base/text/html.h"
#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"
#include "bench/report/exponent.h"

namespace sparsha::bench {
namespace {

constexpr double kFloor_s = 0.002;  // stages below are start-up and the clock
constexpr double kTickFloor_s = 1e-9;
const std::vector<std::string> kAgainst = {"points", "nodes"};

struct Series {
  std::string name;
  std::vector<double> counts, seconds;
};

std::vector<Series> stages_of(const Table& table, const std::string& against) {
  std::vector<Series> all;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (table.text(row, "against") != against) continue;
    const std::string name = table.text(row, "stage");
    auto found = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == name; });
    if (found == all.end()) found = all.insert(all.end(), {name, {}, {}});
    found->counts.push_back(table.number(row, against));
    found->seconds.push_back(table.number(row, "seconds"));
  }
  return all;
}

/// Updates of the methods of the race against the nodes, from its group `size`.
std::vector<Series> updates_of(const Table& race) {
  std::vector<Series> all;
  for (std::size_t row = 0; row < race.rows.size(); ++row) {
    if (race.text(row, "group") != "size") continue;
    const std::string name = race.text(row, "method");
    auto found = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == name; });
    if (found == all.end()) found = all.insert(all.end(), {name, {}, {}});
    found->counts.push_back(race.number(row, "points"));
    found->seconds.push_back(1e-9 * race.number(row, "p50_ns"));
  }
  return all;
}

std::string exponent_text(const Exponent& fit) {
  if (fit.counts < 2) return "too short to tell";
  std::string text = text_of("%.2f", fit.value);
  if (fit.counts > 2) text += " ± " + text_of("%.2f", fit.error);
  return text + " (" + std::to_string(fit.counts) + " sizes)";
}

std::string time_of(double seconds) { return time_text(1e9 * seconds); }

std::string table_of(const std::vector<Series>& all, const std::string& caption, const std::string& count_name,
                     double floor_s) {
  std::vector<double> counts;
  for (const Series& s : all) counts.insert(counts.end(), s.counts.begin(), s.counts.end());
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  if (counts.empty()) return {};
  std::vector<std::string> heads = {count_name == "points" ? "stage" : count_name == "nodes" ? "stage" : "method"};
  for (const double count : counts)
    heads.push_back(text_of("%.0f ", count) + (count_name == "points" ? "points" : "nodes"));
  heads.emplace_back("exponent");
  std::vector<HtmlRow> rows;
  for (const Series& s : all) {
    HtmlRow cells{{escape_html(s.name)}};
    for (const double count : counts) {
      const auto at = std::find(s.counts.begin(), s.counts.end(), count);
      cells.push_back(
          {at == s.counts.end() ? "" : time_of(s.seconds[static_cast<std::size_t>(at - s.counts.begin())])});
    }
    cells.push_back({exponent_text(fit_exponent(s.counts, s.seconds, floor_s))});
    rows.push_back(cells);
  }
  return html_table(caption, heads, rows);
}

// One row for what each program took of each kind.
std::string programs_table(const Table& sites) {
  struct Kind {
    const char* column;
    const char* name;
    const char* format;
    double floor;  // smaller ones are start-up
  };
  const std::array<Kind, 4> kinds{
      Kind{"seconds", "time", "%.2f s", 0.1}, Kind{"peak_mb", "peak memory", "%.0f MB", 50.0},
      Kind{"read_mb", "read from disk", "%.0f MB", 1.0}, Kind{"written_mb", "written to disk", "%.0f MB", 1.0}};
  std::vector<double> counts;
  std::vector<std::string> programs;
  const auto once = [](auto& list, const auto& value) {
    if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
  };
  for (std::size_t row = 0; row < sites.rows.size(); ++row) {
    once(counts, sites.number(row, "points"));
    once(programs, sites.text(row, "program"));
  }
  std::sort(counts.begin(), counts.end());
  std::vector<std::string> heads = {"program", "takes"};
  for (const double count : counts) heads.push_back(text_of("%.0f ", count) + "points");
  heads.emplace_back("exponent");
  std::vector<HtmlRow> rows;
  for (const std::string& program : programs) {
    for (const Kind& kind : kinds) {
      HtmlRow cells{{escape_html(program)}, {kind.name}};
      std::vector<double> had, values;
      for (const double count : counts) {
        std::string text;
        for (std::size_t row = 0; row < sites.rows.size(); ++row) {
          if (sites.text(row, "program") != program || sites.number(row, "points") != count) continue;
          had.push_back(count);
          values.push_back(sites.number(row, kind.column));
          text = text_of(kind.format, values.back());
        }
        cells.push_back({text});
      }
      cells.push_back({exponent_text(fit_exponent(had, values, kind.floor))});
      rows.push_back(cells);
    }
  }
  return html_table("Whole programs against the points, start and files included", heads, rows);
}

}  // namespace

std::string scaling_html(const std::filesystem::path& folder) {
  std::string html;
  if (const auto stages = read_table(folder / "pipeline_scaling.csv"))
    for (const std::string& against : kAgainst)
      html += table_of(stages_of(*stages, against),
                       against == "points" ? "Stages of a build against the points, 160 000 nodes"
                                           : "Stages of a build against the nodes, the same number of points",
                       against, kFloor_s);
  if (const auto sites = read_table(folder / "pipeline_sites.csv")) html += programs_table(*sites);
  if (const auto race = read_table(folder / "race.csv"))
    html += table_of(updates_of(*race), "Median update of each method against the points of its surface", "size",
                     kTickFloor_s);
  if (html.empty()) return {};
  return html_heading("Scaling") +
         "<p>Time = a · count<sup>exponent</sup>, fitted in the logarithms over the sizes that take at least 2 ms (a "
         "stage) on one thread; ± is the 95 % interval of the fit. An exponent of 1 is linear. Below 1 something that "
         "does not grow still counts: against the points, work on the nodes; against the nodes, work on the "
         "points. Above 1 on finer grids: filters whose reach is in metres have more nodes in it. Where ± exceeds 1 "
         "the times "
         "follow no power. The hand's speed in the last table is the same in metres, so that it crosses more cells on "
         "finer "
         "surfaces.</p>" +
         html;
}

}  // namespace sparsha::bench
