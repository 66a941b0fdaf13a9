// The first lines of the page: what this very run has found.
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text/html.h"
#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"

namespace sparsha::bench {
namespace {

std::string rendering(const Table& race) {
  std::optional<std::size_t> exact, c1;
  std::size_t feelable = 0, methods = 0;
  for (std::size_t row = 0; row < race.rows.size(); ++row) {
    if (race.text(row, "group") != "front") continue;
    ++methods;
    if (race.number(row, "force_error_p99") > 0.07) ++feelable;
    if (!exact && race.text(row, "method") == "exact") exact = row;
    if (!c1 && race.text(row, "method") == "c1") c1 = row;
  }
  if (!exact) return {};
  std::string text =
      "<li>On the paper's sinusoid <code>exact</code> takes " + time_text(race.number(*exact, "p50_ns")) +
      " at the median and " + time_text(race.number(*exact, "p99_ns")) +
      " at the 99th percentile with a median force error of " + share_text(race.number(*exact, "force_error_median"));
  if (c1)
    text += "; <code>c1</code> " + time_text(race.number(*c1, "p50_ns")) + " with " +
            share_text(race.number(*c1, "force_error_median"));
  for (std::size_t row = 0; row < race.rows.size(); ++row)
    if (race.text(row, "group") == "front" && race.text(row, "method") == "god-object") {
      text += "; <code>god-object</code> " + time_text(race.number(row, "p50_ns")) + " with " +
              share_text(race.number(row, "force_error_median"));
      break;
    }
  return text + ". Of " + std::to_string(methods) + " settings of all methods " + std::to_string(feelable) +
         " have errors that touch notices (99 % above 7 %).</li>";
}

std::string faster(const Table& race) {
  const auto exact_ns = [&](std::size_t like) {
    for (std::size_t row = 0; row < race.rows.size(); ++row) {
      bool same = race.text(row, "method") == "exact";
      for (const char* name : {"group", "surface", "points", "speed_m_per_s", "depth_m"})
        same = same && race.text(row, name) == race.text(like, name);
      if (same) return race.number(row, "p50_ns");
    }
    return 0.0;
  };
  std::vector<std::string> names;
  for (std::size_t row = 0; row < race.rows.size(); ++row) {
    const std::string method = race.text(row, "method");
    const bool peer = method != "exact" && method != "rounded" && method != "c1" && method != "paper";
    if (peer && race.number(row, "ratio_high") < 1.0 && exact_ns(row) > 0.0 &&
        std::find(names.begin(), names.end(), method) == names.end())
      names.push_back(method);
  }
  if (names.empty()) return {};
  std::string text = "<li>Peers that were surely faster than <code>exact</code> somewhere:";
  for (const std::string& name : names) text += " <code>" + name + "</code>";
  return text + "; the chapter on where a peer is better says how often and at what error.</li>";
}

std::string losers(const Table& race) {
  constexpr double kMany = 0.5;  // of the ticks
  std::string names;
  for (std::size_t row = 0; row < race.rows.size(); ++row) {
    if (race.text(row, "group") != "surfaces" || !(race.number(row, "lost") > kMany)) continue;
    names += (names.empty() ? " <code>" : ", <code>") + escape_html(race.text(row, "method")) + "</code> on " +
             escape_html(race.text(row, "surface")) + " of " + text_of("%.0f", race.number(row, "points")) +
             " points (" + share_text(race.number(row, "lost")) + ")";
  }
  return names.empty()
             ? ""
             : "<li>Missed the contact in more than half of the ticks, so that their times there are those of "
               "free space:" +
                   names + ".</li>";
}

std::string hard(const Table& table) {
  std::vector<std::string> methods, failing;
  const auto add = [](std::vector<std::string>& list, const std::string& name) {
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  };
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    add(methods, table.text(row, "method"));
    if (table.text(row, "verdict") != "pass") add(failing, table.text(row, "method"));
  }
  std::string text = "<li>Methods that pass every hard case:";
  bool any = false;
  for (const std::string& name : methods)
    if (std::find(failing.begin(), failing.end(), name) == failing.end())
      text += " <code>" + name + "</code>", any = true;
  return text + (any ? "" : " none") + ", of " + std::to_string(methods.size()) + ".</li>";
}

std::string heights(const Table& table, const char* group, const char* value, const char* unit, const char* what) {
  std::string text;
  std::string best;
  double ours = std::nan(""), least = INFINITY;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (table.text(row, "varied") != "base" || table.text(row, group) != table.text(0, group)) continue;
    const double error = table.number(row, value);
    if (table.text(row, "method") == "sparsha") {
      ours = error;
    } else if (error < least) {
      least = error;
      best = table.text(row, "method");
    }
  }
  if (std::isnan(ours) || best.empty()) return {};
  return "<li>Heights of " + std::string(what) + ": " + text_of("%.3g ", ours) + unit + " RMS, the best other way (" +
         escape_html(best) + ") " + text_of("%.3g ", least) + unit + ".</li>";
}

std::string lateness(const Table& table) {
  std::string text;
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    text += (text.empty() ? "" : "; ") + escape_html(table.text(row, "method")) + ", " +
            escape_html(table.text(row, "state")) + ": " +
            text_of("%.3f %%", 100.0 * table.number(row, "share_in_time"));
  return "<li>Ticks in time at 1 kHz: " + text + ".</li>";
}

}  // namespace

std::string findings_html(const std::filesystem::path& folder) {
  std::string list;
  if (const auto race = read_table(folder / "race.csv")) list += rendering(*race) + faster(*race) + losers(*race);
  if (const auto table = read_table(folder / "race_hard.csv"); table && !table->rows.empty()) list += hard(*table);
  if (const auto table = read_table(folder / "pipeline_open_peers.csv"); table && !table->rows.empty())
    list += heights(*table, "back", "rms_away_mm", "mm", "an open relief with a sparse back");
  if (const auto table = read_table(folder / "pipeline_closed_peers.csv"); table && !table->rows.empty())
    list += heights(*table, "object", "rms_spacings", "point spacings", "a closed object");
  if (const auto table = read_table(folder / "realtime.csv"); table && !table->rows.empty()) list += lateness(*table);
  return list.empty() ? std::string() : "<p><strong>What this run found</strong></p><ul>\n" + list + "</ul>\n";
}

}  // namespace sparsha::bench
