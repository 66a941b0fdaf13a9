// What the scans say of their points' worth, beside what the configuration makes of it.
#pragma once

#include <vector>

#include "base/threads/progress.h"
#include "pipeline/scan/set.h"
#include "scene/config/filters.h"
#include "scene/config/scans.h"

namespace sparsha::pipeline {

/// Throws Error{input} at the key of a filter whose field no scan has, with the fields that they have; warns of scans
/// that have none where others do.
void require_fields(const std::vector<scene::ScanConfig>& configs, const ScanSet& scans,
                    const std::vector<scene::FilterConfig>& filters, Progress& progress);

/// Warns of noise classes, low confidence and the like that no filter looks at.
void warn_of_unused_worth(const std::vector<scene::ScanConfig>& configs, const ScanSet& scans,
                          const std::vector<scene::FilterConfig>& filters, Progress& progress);

}  // namespace sparsha::pipeline
