// What `sparsha register` found, as one page: which scans meet, and how closely, before and after.
#pragma once

#include <string>
#include <vector>

#include "pipeline/report/report.h"

namespace sparsha::pipeline {

/// `name`: of the configuration. `notes`: sentences that stand before the graph. The page loads nothing from anywhere
/// and runs no script.
[[nodiscard]] std::string registration_page(const std::string& name, const std::vector<std::string>& notes,
                                            const std::vector<ScanPair>& pairs);

}  // namespace sparsha::pipeline
