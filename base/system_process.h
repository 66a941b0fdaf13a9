// Other programs and libraries, as the system starts and loads them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sparsha::system {

/// A shared library, found as the system finds them; null when it is not there. Stays loaded.
[[nodiscard]] void* load_library(const char* name) noexcept;
/// A function of it or of the libraries that it needs; null when there is none.
[[nodiscard]] void* symbol(void* library, const char* name) noexcept;

/// This program's own file; empty when the system does not tell.
[[nodiscard]] std::filesystem::path program_file();

/// Runs a program to its end, with this one's standard streams, environment and the variables of `more`. Its exit code;
/// 128 and the signal's number when a signal has ended it. `stop` is asked a hundred times a second: when it returns
/// true the program is asked to end (SIGTERM, unless a terminal has told both), and ended (SIGKILL) ten seconds later.
/// Throws Error{usage} when there is no such program.
[[nodiscard]] int run_program(const std::vector<std::string>& command,
                              const std::vector<std::pair<std::string, std::string>>& more,
                              const std::function<bool()>& stop);

}  // namespace sparsha::system
