// Other programs, with their wall time and highest memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sparsha::bench {

struct ProcessResult {
  int exit_code = -1;
  double seconds = 0.0;      ///< wall
  double cpu_seconds = 0.0;  ///< user and system
  std::uint64_t peak_rss_bytes = 0;
  std::uint64_t read_bytes = 0, written_bytes = 0;  ///< from and to the disk, as the system counts them
};

/// Runs a program found on PATH without a display; its output is thrown away.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& command);
/// Runs a function in a process of its own; an exception is exit code 1.
[[nodiscard]] ProcessResult run_child(const std::function<void()>& work);
/// Lets the system forget a file's pages, so that the next who reads it reads the disk.
void forget_pages(const std::filesystem::path& file);
/// True when `name` is on PATH.
[[nodiscard]] bool on_path(const std::string& name);

}  // namespace sparsha::bench
