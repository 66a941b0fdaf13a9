// The chapters of the benchmarks' page that are made from CSV files and plots of one folder.
#pragma once

#include <filesystem>
#include <string>

namespace sparsha::bench {

/// What the run has found, in figures of its own CSV files; sentences without their files are left out.
[[nodiscard]] std::string findings_html(const std::filesystem::path& folder);
/// Friction and texture.
[[nodiscard]] std::string effects_html(const std::filesystem::path& folder);
/// Touch of whole objects.
[[nodiscard]] std::string objects_html(const std::filesystem::path& folder);
/// Rasters by density, noise and spacing; closed objects, filters, registration, normals, accuracy, transfer, builds.
[[nodiscard]] std::string pipeline_html(const std::filesystem::path& folder);
/// Time of each stage against points and nodes, with its exponent.
[[nodiscard]] std::string scaling_html(const std::filesystem::path& folder);
/// The source paper's figures and tables again.
[[nodiscard]] std::string paper_html(const std::filesystem::path& folder);
/// Lateness of the loop with and without viewer and sound, stability, sound.
[[nodiscard]] std::string real_time_html(const std::filesystem::path& folder);
/// The other files of the folder.
[[nodiscard]] std::string files_html(const std::filesystem::path& folder);

}  // namespace sparsha::bench
