#include "pipeline/scan/up_axes.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/scan/named_file.h"
#include "pipeline/scan/reader.h"

namespace sparsha::pipeline {

std::optional<UpDifference> differing_up(const std::vector<ScanUp>& scans) {
  std::vector<std::string> with_z;
  std::vector<std::string> with_y;
  UpDifference difference;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (scans[s].turned) continue;
    if (is_z_up(scans[s].format)) with_z.push_back(scans[s].name);
    if (!is_y_up(scans[s].format)) continue;
    if (with_y.empty()) difference.scan = s;
    with_y.push_back(scans[s].name);
  }
  if (with_z.empty() || with_y.empty()) return std::nullopt;
  difference.reason = fmt::format(
      "by their formats z is up in {} and y is up in {}: if they show one object, they are crossed at a right angle; "
      "'pose: {{euler_deg: [90, 0, 0]}}' of a scan in the configuration turns its y to z",
      names_together(with_z), names_together(with_y));
  return difference;
}

}  // namespace sparsha::pipeline
