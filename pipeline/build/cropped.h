// What the filters at the start of a list leave unread: points outside of a box need not be looked at.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/report/report.h"
#include "pipeline/scan/set.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// Whether any of the filters may leave one of several pieces.
[[nodiscard]] bool take_places_away(const std::vector<scene::FilterConfig>& filters);

/// The part of the scans outside of which the filters at the start of the list keep no point. `force`: see
/// BuildOptions.
[[nodiscard]] ScanPart part_left_by_crops(const std::vector<scene::FilterConfig>& filters, bool force);

/// Counts points that were left unread as read, and as taken away by the first crop.
void count_unread(std::uint64_t unread, Report::Points& points, std::vector<Report::Filter>& filters);

}  // namespace sparsha::pipeline
