#include "pipeline/report/registration_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text/html.h"
#include "pipeline/report/page.h"
#include "pipeline/report/scan_graph.h"
#include "pipeline/report/svg.h"

namespace sparsha::pipeline {

std::string registration_page(const std::string& name, const std::vector<std::string>& notes,
                              const std::vector<ScanPair>& pairs) {
  const auto linked = std::count_if(pairs.begin(), pairs.end(), [](const ScanPair& pair) { return pair.linked; });
  std::string html = page_head(escape_html(name), "Registration",
                               fmt::format("{} of {} pairs of scans hold them together.", linked, pairs.size()));
  html += "</header>\n<main id='main'>\n<section aria-labelledby='pairs-h'><h2 id='pairs-h'>Pairs of scans</h2>";
  for (const std::string& note : notes) html += "<p>" + escape_html(note) + "</p>";
  return html + scan_graph_html(pairs) + "</section>\n" + page_end();
}

}  // namespace sparsha::pipeline
