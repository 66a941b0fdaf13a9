// Scans that are listed more than once, and what tells files apart.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/threads/progress.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

/// The scans without those that repeat an earlier one: the same bytes, units and pose. They would cost time and memory,
/// count each point twice, and tell nothing; a warning says how many there were. Few bytes are read of files that
/// differ; files that cannot be read stay, for their reader to say why.
[[nodiscard]] std::vector<scene::ScanConfig> without_repeats(const std::vector<scene::ScanConfig>& scans,
                                                             Progress& progress);

/// SHA-256 of the first and the last 64 KiB of a file. Throws Error{input} when it cannot be read.
[[nodiscard]] std::string digest_of_ends(const std::filesystem::path& file);

/// Of all bytes of a file up to 4 MiB, else of 64 pieces of 64 KiB from its beginning to its end. Throws as above.
[[nodiscard]] std::string digest_of_places(const std::filesystem::path& file);

}  // namespace sparsha::pipeline
