// Which scans meet which, how much of them and how closely: a drawing and a table.
#pragma once

#include <string>
#include <vector>

#include "pipeline/report/report.h"

namespace sparsha::pipeline {

/// Empty without pairs.
[[nodiscard]] std::string scan_graph_html(const std::vector<ScanPair>& pairs);

}  // namespace sparsha::pipeline
