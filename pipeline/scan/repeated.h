// Scans that are listed more than once.
#pragma once

#include <vector>

#include "base/threads/progress.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

/// The scans without those that repeat an earlier one: the same bytes, units and pose. They would cost time and memory,
/// count each point twice, and tell nothing; a warning says how many there were. Few bytes are read of files that
/// differ; files that cannot be read stay, for their reader to say why.
[[nodiscard]] std::vector<scene::ScanConfig> without_repeats(const std::vector<scene::ScanConfig>& scans,
                                                             Progress& progress);

}  // namespace sparsha::pipeline
