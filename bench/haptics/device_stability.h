// The tables of docs/touch.md of devices as they are: what a simulated hand gets of a Falcon, and of an Inverse3 behind
// its vendor's service.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// Prints the tables and writes haptics_device_stability.csv; false when that could not be written.
[[nodiscard]] bool write_device_stability(const std::filesystem::path& folder, bool quick);

}  // namespace sparsha::bench
