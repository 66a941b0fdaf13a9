// Scans stand on a circle; the more two have in common, the thicker the line between them.
#include "pipeline/report/scan_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/text/html.h"
#include "base/text/text.h"
#include "pipeline/report/svg.h"

namespace sparsha::pipeline {
namespace {

std::vector<std::string> scans_of(const std::vector<ScanPair>& pairs) {
  std::vector<std::string> names;
  for (const ScanPair& pair : pairs) {
    for (const std::string& name : {pair.first, pair.second})
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string drawing(const std::vector<ScanPair>& pairs) {
  const std::vector<std::string> names = scans_of(pairs);
  const auto at = [&](const std::string& name) {
    const auto k = std::find(names.begin(), names.end(), name) - names.begin();
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(names.size());
    return std::pair(240.0 - 140.0 * std::cos(angle), 110.0 - 80.0 * std::sin(angle));
  };
  std::string svg =
      "<svg viewBox='0 0 480 220' width='480' height='220' role='img' aria-label='Graph of the scans; the table below "
      "has its figures'>";
  for (const ScanPair& pair : pairs) {
    const auto [x1, y1] = at(pair.first);
    const auto [x2, y2] = at(pair.second);
    svg += fmt::format(
        "<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' stroke='currentColor' stroke-width='{:.1f}'{}/>", x1, y1,
        x2, y2, 1.0 + 5.0 * pair.fit.overlap, pair.linked ? "" : " stroke-dasharray='3 4'");
  }
  for (const std::string& name : names) {
    const auto [x, y] = at(name);
    svg += fmt::format(
        "<circle cx='{0:.1f}' cy='{1:.1f}' r='7' fill='currentColor'/><text x='{0:.1f}' y='{2:.1f}' "
        "text-anchor='middle' font-size='12' fill='currentColor'>{3}</text>",
        x, y, y < 110.0 ? y - 12.0 : y + 20.0, escape_html(std::filesystem::path(name).filename().string()));
  }
  return svg + "</svg>";
}

std::string cells(const ScanPair::Fit& fit) {
  return fmt::format("<td>{:.1f}\u202F%</td><td>{}</td>", 100.0 * fit.overlap,
                     fit.overlap > 0.0 ? length_text(fit.residual_m, TextStyle::typeset) : "\u2013");
}

std::string within(const ScanPair::Fit& fit) { return length_text(fit.within_m, TextStyle::typeset); }

}  // namespace

std::string scan_graph_html(const std::vector<ScanPair>& pairs) {
  if (pairs.empty()) return {};
  const ScanPair& first = pairs.front();
  const bool twice = first.before.has_value();
  const std::string distance = twice
                                   ? within(*first.before) + " of the other before and " + within(first.fit) + " after"
                                   : within(first.fit) + " of the other";
  const char* const columns = twice ? "<th scope='col'>Overlap before</th><th scope='col'>Residual before</th>"
                                      "<th scope='col'>Overlap after</th><th scope='col'>Residual after</th>"
                                    : "<th scope='col'>Overlap</th><th scope='col'>Residual</th>";
  std::string html = "<h3>How the scans fit each other</h3>" + drawing(pairs) +
                     fmt::format(
                         "<div class='scroll' tabindex='0' role='region' aria-label='Table of pairs of scans'><table>"
                         "<caption>Overlap: the larger share of one scan's points that lie within {}; "
                         "residual: RMS distance there. Dashed lines: too little in common</caption><thead><tr><th "
                         "scope='col' class='text'>Scans</th>{}</tr></thead><tbody>",
                         distance, columns);
  for (const ScanPair& pair : pairs) {
    html += fmt::format("<tr><th scope='row'>{} \u2013 {}</th>{}{}</tr>",
                        escape_html(std::filesystem::path(pair.first).filename().string()),
                        escape_html(std::filesystem::path(pair.second).filename().string()),
                        twice ? cells(pair.before.value_or(ScanPair::Fit{})) : "", cells(pair.fit));
  }
  return html + "</tbody></table></div>";
}

}  // namespace sparsha::pipeline
