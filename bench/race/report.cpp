#include "report.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

namespace sparsha::bench {
namespace {

constexpr double kFelt = 0.07;

std::string text(const char* format, double value) {
  char line[64];
  std::snprintf(line, sizeof line, format, value);
  return line;
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string time_text(double ns) {
  if (ns < 1e3) return text("%.0f ns", ns);
  return ns < 1e6 ? text("%.2f µs", 1e-3 * ns) : text("%.2f ms", 1e-6 * ns);
}

std::string size_text(std::size_t bytes) { return text("%.2f MB", 1e-6 * static_cast<double>(bytes)); }

std::string share_text(double share) { return text("%.3g %%", 100.0 * share); }

struct Cell {
  std::string words;
  bool fault = false;
};

class Page {
 public:
  explicit Page(const std::filesystem::path& file) : html_(file) {
    html_ << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
             "content=\"width=device-width\"><title>Sparsha: speed against error</title>\n<style>body{font:16px/1.5 "
             "sans-serif;max-width:75rem;margin:2rem auto;padding:0 "
             "1rem;color:#111;background:#fff}table{border-collapse:"
             "collapse;margin:1rem 0;font-size:.9rem}caption{text-align:left;font-weight:bold;padding:.3rem "
             "0}th,td{border:"
             "1px solid #888;padding:.2rem .5rem;text-align:right}th[scope=row],td.words{text-align:left}thead th{"
             "background:#eee}td.fault{font-weight:bold;background:#fdd}svg{max-width:100%;height:auto}"
             "div.wide{overflow-x:auto}</style></head>\n<body><main>\n";
  }
  void add(const std::string& html) { html_ << html << '\n'; }
  void table(const std::string& caption, const std::vector<std::string>& heads,
             const std::vector<std::vector<Cell>>& rows) {
    html_ << "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"" << caption << "\"><table><caption>"
          << caption << "</caption><thead><tr>";
    for (const std::string& head : heads) html_ << "<th scope=\"col\">" << head << "</th>";
    html_ << "</tr></thead><tbody>\n";
    for (const auto& row : rows) {
      html_ << "<tr>";
      for (std::size_t k = 0; k < row.size(); ++k)
        html_ << (k == 0         ? "<th scope=\"row\">"
                  : row[k].fault ? "<td class=\"fault\">"
                                 : "<td>")
              << row[k].words << (k == 0 ? "</th>" : "</td>");
      html_ << "</tr>\n";
    }
    html_ << "</tbody></table></div>\n";
  }
  [[nodiscard]] bool finish() {
    html_ << "</main></body></html>\n";
    return static_cast<bool>(html_.flush());
  }

 private:
  std::ofstream html_;
};

std::vector<Cell> cells_of(const Row& row) {
  return {{row.method + ", " + row.setting},
          {row.ground},
          {text("%.0f", static_cast<double>(row.nodes) * row.nodes)},
          {text("%g m/s", row.speed_m_per_s)},
          {text("%.3g mm", 1e3 * row.depth_m)},
          {text("%.3g", row.cells_per_tick)},
          {time_text(row.p50_ns)},
          {time_text(row.p99_ns)},
          {time_text(row.max_ns), row.max_ns > 1e6},
          {text("%.3g", row.ratio) + " (" + text("%.3g", row.ratio_low) + " to " + text("%.3g", row.ratio_high) + ")"},
          {share_text(row.error_median), row.error_median > kFelt},
          {share_text(row.error_p99), row.error_p99 > kFelt},
          {share_text(row.size_median) + " / " + share_text(row.size_p99)},
          {text("%.2g°", row.angle_median_deg) + " / " + text("%.2g°", row.angle_p99_deg)},
          {share_text(row.lost), row.lost > 0.0},
          {share_text(row.jumps), row.jumps > 0.0},
          {text("%.3g s", row.seconds)},
          {size_text(row.bytes)}};
}

void add_rows(Page& page, const std::vector<Row>& rows, const std::string& group, const std::string& caption) {
  std::vector<std::vector<Cell>> cells;
  for (const Row& row : rows)
    if (row.group == group) cells.push_back(cells_of(row));
  if (cells.empty()) return;
  page.table(caption,
             {"method", "surface", "points", "speed", "depth", "cells per tick", "median", "99 %", "longest",
              "time over exact's (interval)", "force error, median", "force error, 99 %", "size error, median / 99 %",
              "direction, median / 99 %", "lost ticks", "jumps felt", "pre-processing", "memory"},
             cells);
}

/// Where another method has less error or less time than `exact`, on the rows of this very run.
void add_where_peers_win(Page& page, const std::vector<Row>& rows) {
  std::map<std::string, const Row*> exact;
  const auto key = [](const Row& r) {
    return r.group + r.ground + std::to_string(r.nodes) + "/" + std::to_string(r.speed_m_per_s) + "/" +
           std::to_string(r.depth_m);
  };
  for (const Row& row : rows)
    if (row.method == "exact" && exact.count(key(row)) == 0) exact[key(row)] = &row;
  struct Count {
    int all = 0, faster = 0, nearer = 0, both = 0;
  };
  std::map<std::string, Count> counts;
  for (const Row& row : rows) {
    if (row.method == "exact" || exact.count(key(row)) == 0) continue;
    const Row& ours = *exact[key(row)];
    Count& c = counts[row.method];
    const bool faster = row.ratio_high < 1.0;
    const bool nearer = row.error_median < 0.99 * ours.error_median && row.lost <= ours.lost;
    ++c.all;
    c.faster += faster ? 1 : 0;
    c.nearer += nearer ? 1 : 0;
    c.both += faster && nearer ? 1 : 0;
  }
  std::vector<std::vector<Cell>> cells;
  for (const auto& [method, c] : counts) {
    const auto of = [n = c.all](int part) { return std::to_string(part) + " of " + std::to_string(n); };
    cells.push_back({{method}, {of(c.faster)}, {of(c.nearer)}, {of(c.both)}});
  }
  page.table("Rows of this run in which a method is better than <code>exact</code>",
             {"method", "surely faster (whole interval below 1)", "smaller median error, no more lost ticks", "both"},
             cells);
}

void add_hard(Page& page, const std::vector<HardResult>& hard) {
  std::vector<std::string> methods;
  for (const HardResult& r : hard)
    if (std::find(methods.begin(), methods.end(), r.method) == methods.end()) methods.push_back(r.method);
  std::vector<std::string> heads = {"case"};
  heads.insert(heads.end(), methods.begin(), methods.end());
  std::vector<std::vector<Cell>> cells;
  for (const auto& [name, what] : hard_case_texts()) {
    std::vector<Cell> row = {{"<strong>" + name + "</strong>: " + what}};
    for (const std::string& method : methods)
      for (const HardResult& r : hard) {
        if (r.hard_case != name || r.method != method) continue;
        std::string words = r.verdict;
        if (r.lost > 0.0) words += "<br>lost " + share_text(r.lost);
        if (r.gained != 0.0) words += "<br>energy " + text("%+.2g %%", 100.0 * r.gained);
        if (r.worst_step > 0.0) words += "<br>step " + text("%.2g %%", 100.0 * r.worst_step);
        row.push_back({words, r.verdict != "pass"});
      }
    cells.push_back(row);
  }
  page.table("Hard cases by method", heads, cells);
}

void add_files(Page& page, const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".csv" || entry.path().extension() == ".svg")
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  std::string list = "<ul>";
  for (const std::string& name : names) list += "<li><a href=\"" + name + "\">" + name + "</a></li>";
  page.add("<h2>All figures</h2><p>Files beside this page:</p>" + list + "</ul>");
}

std::string file_text(const std::filesystem::path& file) {
  std::ostringstream words;
  words << std::ifstream(file).rdbuf();
  return words.str();
}

constexpr const char* kIntroduction =
    "<p>Every method is made from the same nodes of an analytic surface of 1 m × 1 m (points without noise), follows "
    "the "
    "same hand at 1 kHz and is judged by the same truth in closed form: the nearest point of the analytic surface. "
    "<code>exact</code>, <code>rounded</code>, <code>c1</code> and <code>paper</code> are Sparsha's solvers; "
    "<code>god-object</code> (Zilles and Salisbury 1995, sliding on within a tick as Ruspini did), <code>sphere</code> "
    "(Sreeni and Chaudhuri 2012), <code>mls</code> (Lee and Kim 2007), <code>implicit</code> (Leeper, Chan and "
    "Salisbury "
    "2012), <code>box</code> (El-Far, Georganas and El Saddik 2008) and <code>voxel</code> (a distance field, McNeely "
    "1999) "
    "were written for this race from the publications.</p><p>Methods take turns in one run. A tick's time is the best "
    "of its "
    "repeats, less the timer; “longest” is the largest of these. “Time over exact's” is the median of the ratios of "
    "mean "
    "times in the same repeat; the interval, their whole range, holds the true median with a probability of %s. Force "
    "error is the length of "
    "the error vector over the true force; a tick without force counts 100 %%, one whose error is as large as the "
    "force is "
    "lost. A jump is a change of force in one tick that differs from the true change by 7 %% of the force, the least "
    "that "
    "touch notices (7 to 10 %%). Coloured cells are beyond that, lost, or over 1 ms.</p>";

// How the methods differ by what they are; which is ahead where is in the tables of the run.
constexpr const char* kHonest =
    "<p>How to read it. <code>voxel</code> looks a distance up, so that its time depends neither on speed nor on the "
    "cells crossed; it pays with memory, with pre-processing and with the depth at which the hand is lost. "
    "<code>c1</code> follows the surface between nodes with a curvature that a bilinear cell, <code>exact</code>, does "
    "not have, and overshoots at steps, which clean nodes do not show. <code>box</code> and <code>voxel</code> answer "
    "from the hand alone. The mesh and point methods render closed objects and overhangs, which a depth grid cannot. "
    "<code>sphere</code>, <code>mls</code>, <code>implicit</code> and <code>box</code> need no grid, "
    "<code>sphere</code> and <code>implicit</code> not even normals; with points as clean and even as here these "
    "tables cannot show what that is worth. Pre-processing counts from the nodes on; making the grid from a scan is in "
    "the tables of the pipeline. Caches are warm. The peers are ours to tune, and another hand may tune them better. "
    "The intervals of ratios take the repeats for independent, which they are not on a machine that others use.</p>";

}  // namespace

bool write_report(const std::filesystem::path& folder, const Report& report) {
  Page page(folder / "report.html");
  page.add("<h1>Speed against error</h1>");
  const int repeats = report.mode == "full" ? 7 : 5;
  char introduction[4000];
  std::snprintf(introduction, sizeof introduction, kIntroduction, repeats == 7 ? "98 %" : "94 %");
  page.add("<p>Machine: " + processor() + ", " + std::to_string(std::thread::hardware_concurrency()) +
           " threads. Mode: " + report.mode + ". The race took " + text("%.0f s", report.seconds) + ".</p>" +
           introduction);
  page.add("<h2>The front</h2><figure role=\"group\" aria-label=\"Scatter plot; the table below has its figures\">" +
           file_text(folder / "race_front.svg") +
           "<figcaption>Sinusoid of the source paper, the hand 2 mm deep at 0.25 m/s: median time of a tick against "
           "the median "
           "error of the force, every method at every setting. The shaded band is the threshold of touch, the dashed "
           "line the "
           "budget of a tick; no point of the grey line is beaten in both time and error.</figcaption></figure>");
  add_rows(page, report.rows, "front", "The plotted figures");
  page.add("<h2>Where a peer is better</h2>");
  add_where_peers_win(page, report.rows);
  page.add(kHonest);
  page.add("<h2>Surfaces, speed, depth and size</h2>");
  add_rows(page, report.rows, "surfaces", "Every surface");
  add_rows(page, report.rows, "speed", "Speed of the hand");
  add_rows(page, report.rows, "depth", "Depth of the hand");
  add_rows(page, report.rows, "size", "Number of points");
  page.add(
      "<h2>Hard cases</h2><p>On 201 × 201 nodes. <em>lost</em>: below the surface without force in more than 1 % of "
      "the ticks. "
      "<em>energy</em>: over a closed way the hand gains more than 1 % of the spring's largest energy each time round; "
      "below zero it loses. "
      "<em>step</em>: where the hand moves slowly the force changes by more than half of its largest value in one "
      "tick. "
      "<em>NaN</em>: a force or proxy that is not a number; publications say nothing of such hands, and a guard before "
      "the "
      "method cures it.</p>");
  add_hard(page, report.hard);
  add_files(page, folder);
  return page.finish();
}

}  // namespace sparsha::bench
