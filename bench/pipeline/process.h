// Other programs, with their wall time and highest memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sparsha::bench {

struct ProcessResult {
  int exit_code = -1;
  double seconds = 0.0;      ///< wall
  double cpu_seconds = 0.0;  ///< user and system
  std::uint64_t peak_rss_bytes = 0;
};

/// Runs a program found on PATH without a display; its output is thrown away.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& command);
/// True when `name` is on PATH.
[[nodiscard]] bool on_path(const std::string& name);

}  // namespace sparsha::bench
