// The loop as it runs, what a hand gets from it, and what sound costs.
#include <algorithm>

#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"

namespace sparsha::bench {

std::string real_time_html(const std::filesystem::path& folder) {
  std::string html;
  const std::string late = html_of(folder / "realtime.csv", "Ticks of 1 kHz with and without window and sound",
                                   {{"method", "loop"},
                                    {"state", "beside it"},
                                    {"seconds", "seconds"},
                                    {"ticks", "ticks"},
                                    {"missed", "missed"},
                                    {"share_in_time", "in time, %", 100.0},
                                    {"later_1ms", "later than 1 ms"},
                                    {"longest_late_us", "latest, µs"},
                                    {"real_time", "real-time priority"},
                                    {"tick_p50_ns", "tick, median, ns"},
                                    {"tick_p99_ns", "tick, 99 %, ns"},
                                    {"tick_max_ns", "tick, longest, ns"}});
  if (!late.empty()) {
    html += html_heading("Real time") +
            "<p><code>sparsha explore</code> with the simulated hand at 1 kHz, in turns alone and with its window "
            "(software GL) and its sound, and in the same minutes a bare loop that only sleeps, with the same "
            "scheduling one priority below. <em>In time</em>: begun within 1 ms of the plan, missed ticks counted as "
            "late. What the bare loop shows is the machine; what sparsha shows beyond it is ours.</p>" +
            late +
            html_figure(folder / "realtime.svg",
                        "Share of the ticks that begin later than a given time after their plan, logarithmic; the last "
                        "histogram bin is open. The table below has the histogram.");
    if (const auto bins = read_table(folder / "realtime_histogram.csv"))
      html += html_folded("Lateness histograms",
                          html_of(*bins, "Ticks by lateness, bins of 100 µs",
                                  {{"method", "loop"},
                                   {"state", "beside it"},
                                   {"late_from_us", "from, µs"},
                                   {"ticks", "ticks"},
                                   {"share", "share, %", 100.0}},
                                  [&](std::size_t row) { return bins->number(row, "ticks") > 0.0; }));
  }
  const std::string hands =
      html_of(folder / "haptics_stability.csv", "What a simulated hand gets, by loop, ground and hand",
              {{"motion", "motion"},
               {"ground", "ground"},
               {"mass_kg", "mass, kg"},
               {"damping_n_s_per_m", "damping, N s/m"},
               {"delay_s", "delay, ms", 1e3},
               {"declared_ticks", "declared, ticks"},
               {"rate_hz", "rate, Hz"},
               {"planned_hz", "planned, Hz"},
               {"jitter_s", "jitter, ms", 1e3},
               {"lost", "lost ticks, %", 100.0},
               {"lost_told", "told of them"},
               {"wish_n_per_m", "wished, N/m"},
               {"ungoverned_j", "without a governor, mJ", 1e3},
               {"delivered_j", "energy delivered, mJ", 1e3},
               {"swing_m", "swing, µm", 1e6},
               {"altered", "altered ticks, %", 100.0},
               {"calm_s", "calm after, s"}});
  if (!hands.empty())
    html += html_heading("Stability") +
            "<p>A hand of known mass and damping on late, jittering and slow loops (docs/touch.md).</p>" +
            html_figure(folder / "haptics_stability.svg",
                        "The worst over masses, grounds and motions by the hand's damping: energy that it gets beyond "
                        "what the spring gives back, and its swing while it holds.") +
            html_folded("Every hand", hands);
  const std::string drag = html_of(folder / "haptics_drag.csv", "Drag over press on the sample relief without friction",
                                   {{"tip_radius_mm", "tip radius, mm"},
                                    {"depth_mm", "depth of the hand, mm"},
                                    {"spacing_mm", "nodes, mm apart"},
                                    {"drag_over_press", "drag over press"}});
  if (!drag.empty()) html += html_folded("Drag by fingertip and nodes", drag);
  const std::string sound = html_of(folder / "sound.csv", "What sound costs",
                                    {{"method", "method"},
                                     {"voices", "voices"},
                                     {"modes", "modes each"},
                                     {"stroke", "strokes"},
                                     {"core_share", "share of a core, %", 100.0}});
  if (!sound.empty()) html += html_heading("Sound") + sound;
  return html;
}

std::string files_html(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".csv" || entry.path().extension() == ".svg")
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  std::string list = "<ul>";
  for (const std::string& name : names) list += "<li><a href=\"" + name + "\">" + name + "</a></li>\n";
  return html_heading("All figures") +
         "<p>Files beside this page, where it still lies where it was written. <code>sparsha bench export DIR</code> "
         "writes the surfaces, paths and true forces of the race for other programs, and <code>sparsha bench judge DIR "
         "RESULTS.csv</code> scores theirs.</p>" +
         list + "</ul>";
}

}  // namespace sparsha::bench
