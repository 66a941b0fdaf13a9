#include "bench/race/report.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>

#include "bench/report/html.h"
#include "bench/report/turns.h"

namespace sparsha::bench {
namespace {

constexpr double kFelt = 0.07;

/// Whole degrees from 10 on, so that 180 does not become 1.8e+02.
std::string angle_text(double degrees) { return text_of(degrees < 10.0 ? "%.2g°" : "%.0f°", degrees); }
std::string size_text(std::size_t bytes) { return text_of("%.2f MB", 1e-6 * static_cast<double>(bytes)); }

HtmlRow cells_of(const Row& row) {
  return {{row.method + ", " + row.setting},
          {row.ground, false, true},
          {text_of("%.0f", static_cast<double>(row.nodes) * row.nodes)},
          {text_of("%g m/s", row.speed_m_per_s)},
          {text_of("%.3g mm", 1e3 * row.depth_m)},
          {text_of("%.3g", row.cells_per_tick)},
          {time_text(row.p50_ns)},
          {time_text(row.p99_ns)},
          {time_text(row.max_ns), row.max_ns > 1e6},
          {text_of("%.3g", row.ratio) + " (" + text_of("%.3g", row.ratio_low) + " to " +
           text_of("%.3g", row.ratio_high) + ")"},
          {share_text(row.error_median), row.error_median > kFelt},
          {share_text(row.error_p99), row.error_p99 > kFelt},
          {share_text(row.size_median) + " / " + share_text(row.size_p99)},
          {angle_text(row.angle_median_deg) + " / " + angle_text(row.angle_p99_deg)},
          {share_text(row.lost), row.lost > 0.0},
          {share_text(row.jumps), row.jumps > 0.0},
          {text_of("%.3g s", row.seconds)},
          {size_text(row.bytes)}};
}

std::string rows_table(const std::vector<Row>& rows, const std::string& group, const std::string& caption) {
  std::vector<HtmlRow> cells;
  for (const Row& row : rows)
    if (row.group == group) cells.push_back(cells_of(row));
  if (cells.empty()) return {};
  return html_table(
      caption,
      {"method", "surface", "points", "speed", "depth", "cells per tick", "median", "99 %", "longest",
       "time over exact's (interval)", "force error, median", "force error, 99 %", "size error, median / 99 %",
       "direction, median / 99 %", "lost ticks", "jumps felt", "pre-processing", "memory"},
      cells);
}

/// Where another method has less error or less time than `exact`, on the rows of this very run.
std::string where_peers_win(const std::vector<Row>& rows) {
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
  std::vector<HtmlRow> cells;
  for (const auto& [method, c] : counts) {
    const auto of = [n = c.all](int part) { return std::to_string(part) + " of " + std::to_string(n); };
    cells.push_back({{method}, {of(c.faster)}, {of(c.nearer)}, {of(c.both)}});
  }
  return html_table(
      "Rows of this run in which a method is better than exact",
      {"method", "surely faster (whole interval below 1)", "smaller median error, no more lost ticks", "both"}, cells);
}

std::string hard_table(const std::vector<HardResult>& hard) {
  std::vector<std::string> methods;
  for (const HardResult& r : hard)
    if (std::find(methods.begin(), methods.end(), r.method) == methods.end()) methods.push_back(r.method);
  std::vector<std::string> heads = {"case"};
  heads.insert(heads.end(), methods.begin(), methods.end());
  std::vector<HtmlRow> cells;
  for (const auto& [name, what] : hard_case_texts()) {
    HtmlRow row = {{"<strong>" + name + "</strong>: " + what}};
    for (const std::string& method : methods)
      for (const HardResult& r : hard) {
        if (r.hard_case != name || r.method != method) continue;
        std::string words = r.verdict;
        if (r.lost > 0.0) words += "<br>lost " + share_text(r.lost);
        if (r.gained != 0.0) words += "<br>energy " + text_of("%+.2g %%", 100.0 * r.gained);
        if (r.worst_step > 0.0) words += "<br>step " + text_of("%.2g %%", 100.0 * r.worst_step);
        row.push_back({words, r.verdict != "pass", true});
      }
    cells.push_back(row);
  }
  return html_table("Hard cases by method", heads, cells);
}

constexpr const char* kIntroduction =
    "<p>Every method is made from the same nodes of a surface of 1 m × 1 m (points without noise), follows the same "
    "hand at 1 kHz and is judged by the same truth: the nearest point of that surface. Surfaces are formulas; the "
    "sample, the closed object and the scans are cubic splines over their smoothed heights, scaled to 1 m. "
    "<code>exact</code>, <code>rounded</code>, <code>c1</code> and <code>paper</code> are Sparsha's solvers; "
    "<code>god-object</code> (Zilles and Salisbury 1995, sliding on within a tick, and with Ruspini's ball), "
    "<code>sphere</code> "
    "(Sreeni and Chaudhuri 2012), <code>mls</code> (Lee and Kim 2007), <code>implicit</code> (Leeper, Chan and "
    "Salisbury "
    "2012), <code>box</code> (El-Far, Georganas and El Saddik 2008) and <code>voxel</code> (a distance field, McNeely "
    "1999) "
    "were written for this race from the publications; <code>embree</code> (Embree 3, Apache 2.0, where installed) is "
    "the "
    "closest point of the mesh. CGAL's tree of triangles, which would give the same closest point, is under the GPL; "
    "this program links no GPL code, and there is no method <code>cgal</code>.</p><p>Methods take turns in one run, "
    "%d times each. A "
    "tick's time is the best "
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

constexpr const char* kLived =
    "<p>Times above are of warm caches, one tick after the other. A real tick comes out of a sleep of most of a "
    "millisecond. Here the thread wakes every millisecond and one method does its next tick, all of them in turn, so "
    "that each finds the caches as the others left them; ordinary scheduling, every tick once, nothing taken off but "
    "the timer.</p>";

std::string lived_table(const std::vector<LivedRow>& rows) {
  std::vector<HtmlRow> cells;
  for (const LivedRow& row : rows)
    cells.push_back({{row.method},
                     {time_text(row.hot_p50_ns)},
                     {time_text(row.hot_p99_ns)},
                     {time_text(row.p50_ns)},
                     {time_text(row.p99_ns)},
                     {time_text(row.max_ns), row.max_ns > 1e6},
                     {text_of("%.3g", row.p50_ns / std::max(1.0, row.hot_p50_ns))},
                     {share_text(row.error_median), row.error_median > kFelt}});
  return html_table("Woken from sleep at 1 kHz",
                    {"method", "hot, median", "hot, 99 %", "as lived, median", "as lived, 99 %", "as lived, longest",
                     "as lived over hot", "force error, median"},
                    cells);
}

// How the methods differ by what they are; which is ahead where is in the tables of the run.
constexpr const char* kHonest =
    "<p>How to read it. <code>voxel</code> looks a distance up, so that its time depends neither on speed nor on the "
    "cells crossed; it pays with pre-processing, with the depth at which the hand is lost, with memory on small grids "
    "and, "
    "as its voxels are capped, with error on large ones, where it needs less memory than the grid itself. "
    "<code>c1</code> follows the surface between nodes with a curvature that a bilinear cell, <code>exact</code>, does "
    "not have, and overshoots at steps, which clean nodes do not show. <code>box</code> and <code>voxel</code> answer "
    "from the hand alone. The mesh and point methods render closed objects and overhangs, which a depth grid cannot. "
    "<code>sphere</code>, <code>mls</code>, <code>implicit</code> and <code>box</code> need no grid, "
    "<code>sphere</code> and <code>implicit</code> not even normals; with points as clean and even as here these "
    "tables cannot show what that is worth. The setting that a method has everywhere is the one that errs or loses "
    "least "
    "over all surfaces: a larger ball of <code>sphere</code> is nearer to smooth ones and stands off where it does not "
    "fit, a smaller box loses a hand that is deeper than it is wide. Pre-processing counts from the nodes on; making "
    "the grid from a scan is in "
    "the tables of the pipeline. Caches are warm. The peers are ours to tune, and another hand may tune them better. "
    "The intervals of ratios take the repeats for independent, which they are not on a machine that others use.</p>";

}  // namespace

bool write_report(const std::filesystem::path& folder, const Report& report) {
  const std::string confidence = text_of("%.2g %%", 100.0 * range_confidence(report.repeats));
  char introduction[4000];
  std::snprintf(introduction, sizeof introduction, kIntroduction, report.repeats, confidence.c_str());
  std::string html = html_heading("Rendering: the front of time and error") + introduction;
  html += html_figure(folder / "race_front.svg",
                      "Sinusoid of the source paper, the hand 2 mm deep at 0.25 m/s: median time of a tick against the "
                      "median error of the force, every method at every setting; the table below has the figures. The "
                      "shaded band is the threshold of touch, the dashed line the budget of a tick; no point of the "
                      "grey line is beaten in both time and error.");
  html += rows_table(report.rows, "front", "The plotted figures");
  html += html_heading("Rendering: where a peer is better") + where_peers_win(report.rows) + kHonest;
  html += html_heading("Rendering: hot and as lived") + kLived + lived_table(report.lived);
  html += html_heading("Rendering: surfaces, speed, depth and size");
  html += html_folded("Every surface", rows_table(report.rows, "surfaces", "Every surface"));
  html += html_folded("Speed of the hand", rows_table(report.rows, "speed", "Speed of the hand"));
  html += html_folded("Depth of the hand", rows_table(report.rows, "depth", "Depth of the hand"));
  html += html_folded("Number of points", rows_table(report.rows, "size", "Number of points"));
  html += html_heading("Rendering: hard cases") +
          "<p>On 201 × 201 nodes. <em>lost</em>: below the surface without force in more than 1 % of the ticks. "
          "<em>energy</em>: over a closed way the hand gains more than 1 % of the spring's largest energy each time "
          "round; below zero it loses. <em>step</em>: where the hand moves slowly the force changes by more than half "
          "of its largest value in one tick. <em>NaN</em>: a force or proxy that is not a number; publications say "
          "nothing of such hands, and a guard before the method cures it.</p>" +
          hard_table(report.hard);
  std::ofstream file(folder / "race.part.html");
  file << html;
  return static_cast<bool>(file.flush());
}

}  // namespace sparsha::bench
