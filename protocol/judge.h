// Judges anybody's forces against an exported benchmark (protocol/protocol.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "protocol/score.h"

namespace sparsha::protocol {

struct Judgement {
  std::string case_name;
  Score score;
  double ghost = 0.0;            ///< share of the ticks on the way down and up with a wrong force
  double worst_t_s = 0.0;        ///< of the largest error
  int worst_line = 0;            ///< of results.csv
  std::optional<double> p50_ns;  ///< of tick_ns over the judged ticks, where results.csv has it
  std::optional<double> p99_ns;

  [[nodiscard]] bool pass() const {
    return score.felt == 0.0 && score.lost == 0.0 && score.jumps == 0.0 && ghost == 0.0;
  }
};

struct Verdict {
  std::vector<Judgement> cases;     ///< in the order of results.csv
  std::vector<std::string> absent;  ///< cases of the benchmark that results.csv leaves out
};

/// `folder` as export_benchmark() wrote it. Throws Error{input} with file, line and column at the first fault in it or
/// in `results`.
[[nodiscard]] Verdict judge(const std::filesystem::path& folder, const std::filesystem::path& results);

}  // namespace sparsha::protocol
