// The table of docs/touch.md: what a simulated hand gets from loops as they really are.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// Prints the table and writes haptics_stability.csv; false when that could not be written.
[[nodiscard]] bool write_stability(const std::filesystem::path& folder, bool quick);

}  // namespace sparsha::bench
