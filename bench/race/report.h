// build/bench/report.html: one page without other files, for eyes and for screen readers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hard.h"
#include "measure.h"

namespace sparsha::bench {

struct Report {
  std::string mode;  ///< quick or full
  std::vector<Row> rows;
  std::vector<HardResult> hard;
  double seconds = 0.0;
};

/// Reads race_front.svg of the same folder, and says which other results lie beside it. False when it could not be
/// written.
[[nodiscard]] bool write_report(const std::filesystem::path& folder, const Report& report);

}  // namespace sparsha::bench
