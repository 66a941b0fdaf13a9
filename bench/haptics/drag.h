// The fingertip's table of docs/touch.md: drag over press on finer and finer samples of the same stone.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// Prints the table and writes haptics_drag.csv; false when that could not be written.
[[nodiscard]] bool write_drag(const std::filesystem::path& folder);

}  // namespace sparsha::bench
