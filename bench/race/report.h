// The race's chapters of the benchmarks' page (bench/report).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/race/hard.h"
#include "bench/race/lived.h"
#include "bench/race/measure.h"

namespace sparsha::bench {

struct Report {
  int repeats = 1;  ///< of each row: how often each method took its turn
  std::vector<Row> rows;
  std::vector<HardResult> hard;
  std::vector<LivedRow> lived;
};

/// Reads race_front.svg of the same folder and writes race.part.html; false when it could not be written.
[[nodiscard]] bool write_report(const std::filesystem::path& folder, const Report& report);

}  // namespace sparsha::bench
