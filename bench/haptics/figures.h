// The figures of the source paper: z of the proxy and force against time, without surface effects, with texture, and
// with texture and friction.
#pragma once

#include <filesystem>

namespace sparsha::bench {

/// Writes haptics_figures.csv, haptics_z.svg and haptics_force.svg and prints the lags. False when a file cannot be
/// written.
[[nodiscard]] bool write_figures(const std::filesystem::path& out);

}  // namespace sparsha::bench
