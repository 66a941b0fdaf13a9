#include "pipeline/build/cropped.h"

#include <algorithm>
#include <variant>

#include "pipeline/filter/streamed.h"

namespace sparsha::pipeline {
namespace {

bool takes_places_away(const scene::FilterConfig& filter) {
  return std::holds_alternative<scene::KeepConfig>(filter) || std::holds_alternative<scene::CropConfig>(filter) ||
         std::holds_alternative<scene::PassConfig>(filter) || std::holds_alternative<scene::RemovePlaneConfig>(filter);
}

// Whether a filter's verdict on a point does not depend on other points, so that it may come after a crop as well.
bool looks_at_one_point(const scene::FilterConfig& filter) {
  return can_be_streamed(filter) && !std::holds_alternative<scene::RemovePlaneConfig>(filter);
}

}  // namespace

bool take_places_away(const std::vector<scene::FilterConfig>& filters) {
  return std::any_of(filters.begin(), filters.end(), takes_places_away);
}

ScanPart part_left_by_crops(const std::vector<scene::FilterConfig>& filters, bool force) {
  ScanPart part;
  part.whole_chunks_only = force;
  for (const scene::FilterConfig& filter : filters) {
    if (!looks_at_one_point(filter)) break;
    const auto* const crop = std::get_if<scene::CropConfig>(&filter);
    if (crop == nullptr) continue;
    if (!part.box) part.box = *crop;
    part.box->min_m = part.box->min_m.cwiseMax(crop->min_m);
    part.box->max_m = part.box->max_m.cwiseMin(crop->max_m);
  }
  return part;
}

void count_unread(std::uint64_t unread, Report::Points& points, std::vector<Report::Filter>& filters) {
  points.read += unread;
  points.filtered += unread;
  const auto crop =
      std::find_if(filters.begin(), filters.end(), [](const Report::Filter& filter) { return filter.name == "crop"; });
  if (crop != filters.end()) crop->removed += unread;
}

}  // namespace sparsha::pipeline
