// The source paper's validation again, with everything made by the pipeline from a scan: its figures, lags and tables.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// Writes haptics_scanned.csv, haptics_scanned_z.svg, haptics_scanned_force.svg, haptics_lags.csv and
/// haptics_paper_tables.csv; false when one could not be written.
[[nodiscard]] bool write_scanned(const std::filesystem::path& folder, bool quick);

}  // namespace sparsha::bench
