// The table of docs/touch.md of a device behind its vendor's service: what a simulated hand gets of an Inverse3.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// Prints the table and writes haptics_service_stability.csv; false when that could not be written.
[[nodiscard]] bool write_service_stability(const std::filesystem::path& folder, bool quick);

}  // namespace sparsha::bench
