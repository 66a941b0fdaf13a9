// Results as text a person reads.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/check/report.h"
#include "pipeline/scene/scene.h"

namespace sparsha::app {

/// "0.31 mm", "4.2 cm", "12.5 m": three digits in the unit that suits.
[[nodiscard]] std::string length_text(double metres);

/// "1 234 567".
[[nodiscard]] std::string count_text(std::uint64_t count);

/// The few lines `sparsha build` ends with: size, grid, points, coverage, cross-check, time, place.
[[nodiscard]] std::string build_summary(const pipeline::Scene& scene, const pipeline::Report& report,
                                        const std::filesystem::path& folder);

}  // namespace sparsha::app
