// Writes the session's summary as text and as JSON.
#include "app/exploration/run_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text/text.h"

namespace sparsha::app {

namespace {

// "98.1 % below 100 us, 1.2 % below 200 us, ...": the histogram's first bins in words.
std::string lateness_text(const std::vector<std::uint64_t>& histogram) {
  std::uint64_t all = 0;
  for (const std::uint64_t count : histogram) all += count;
  if (all == 0) return "unknown";
  std::string text;
  for (const std::size_t bins : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
    std::uint64_t sum = 0;
    for (std::size_t bin = 0; bin < std::min(bins, histogram.size()); ++bin) sum += histogram[bin];
    text += fmt::format("{}{:.2f} % within {} us", text.empty() ? "" : ", ",
                        100.0 * static_cast<double>(sum) / static_cast<double>(all), 100 * bins);
  }
  return text;
}

}  // namespace

std::string summary_text(const haptics::SessionSummary& s, std::uint64_t strikes) {
  std::string levels;
  for (const int level : s.levels) levels += (levels.empty() ? "" : ", ") + std::to_string(level);
  std::string text;
  text += fmt::format("touched   {:.1f} s of {:.1f} s, {} contacts, {} strikes heard\n", s.contact_s, s.duration_s,
                      s.contacts, strikes);
  text += fmt::format("hand      path {}, force mean {:.2f} N in contact, peak {:.2f} N\n", length_text(s.path_m),
                      s.mean_force_n, s.peak_force_n);
  text += fmt::format("explored  {:.3g} cm2 of the scene, level {}\n", s.area_m2 * 1e4, levels.empty() ? "-" : levels);
  text += fmt::format("ticks     {}, {:.2f} % within 1 ms of plan, {} missed{}\n", count_text(s.ticks),
                      100.0 * s.share_in_time, s.missed_ticks,
                      s.real_time ? "" : " (no real-time priority was granted; see docs/use/hardware.md)");
  text += fmt::format("render    {:.0f} ns median, {:.0f} ns 99 %, {:.0f} ns 99.9 %, {:.0f} ns at most\n",
                      s.tick_ns_p50, s.tick_ns_p99, s.tick_ns_p999, s.tick_ns_max);
  if (s.duration_s > 0.0) text += fmt::format("processor {:.0f} % of a core\n", 100.0 * s.processor_s / s.duration_s);
  std::uint64_t late = 0;
  for (std::size_t bin = 10; bin < s.lateness_histogram.size(); ++bin) late += s.lateness_histogram[bin];
  text += fmt::format("lateness  {}; {} later than 1 ms\n", lateness_text(s.lateness_histogram), late);
  if (s.unfinished + s.faults + s.dropped_records > 0) {
    text += fmt::format("trouble   {} unfinished ticks, {} faults, {} rows not recorded\n", s.unfinished, s.faults,
                        s.dropped_records);
  }
  if (s.watchdog_trips + s.late_faults > 0) {
    text +=
        fmt::format("pauses    {} over 10 ms took the force away: {} seen by the watchdog, {} by the servo itself\n",
                    s.watchdog_trips + s.late_faults, s.watchdog_trips, s.late_faults);
  }
  if (s.runaways > 0)
    text +=
        fmt::format("too soon  {} ticks without force: the device answers faster than it can measure\n", s.runaways);
  if (s.jumps > 0)
    text += fmt::format("jumps     {} positions to which no hand can have come took the force away\n", s.jumps);
  return text;
}

std::string summary_json(const haptics::SessionSummary& s, std::uint64_t strikes) {
  const nlohmann::ordered_json json = {
      {"ticks", s.ticks},
      {"missed_ticks", s.missed_ticks},
      {"share_in_time", s.share_in_time},
      {"real_time", s.real_time},
      {"duration_s", s.duration_s},
      {"processor_s", s.processor_s},
      {"contact_s", s.contact_s},
      {"contacts", s.contacts},
      {"strikes", strikes},
      {"path_m", s.path_m},
      {"mean_force_n", s.mean_force_n},
      {"peak_force_n", s.peak_force_n},
      {"area_m2", s.area_m2},
      {"levels", s.levels},
      {"tick_ns", {{"p50", s.tick_ns_p50}, {"p99", s.tick_ns_p99}, {"p999", s.tick_ns_p999}, {"max", s.tick_ns_max}}},
      {"lateness_histogram_100us", s.lateness_histogram},
      {"late_ns_max", s.late_ns_max},
      {"stiffness_n_per_m", s.stiffness_n_per_m},
      {"watchdog_trips", s.watchdog_trips},
      {"late_faults", s.late_faults},
      {"runaways", s.runaways},
      {"jumps", s.jumps},
      {"locked_memory", s.locked_memory},
      {"windows_loaded", s.windows_loaded},
      {"window_load_s_max", s.window_load_s_max},
      {"swap_ns_max", s.swap_ns_max},
      {"unfinished", s.unfinished},
      {"faults", s.faults},
      {"dropped_records", s.dropped_records}};
  return json.dump(2);
}

}  // namespace sparsha::app
