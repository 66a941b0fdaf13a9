// What a scan itself says of which of its points are worth little: noise classes, low confidence, nearly transparent
// splats; and the filters that leave those out.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/scan/fields.h"
#include "pipeline/scan/reader.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// Of one field that tells_worth() and differs between points.
struct Worth {
  std::string field;                          ///< as field_key() gives it
  std::optional<scene::FilterConfig> filter;  ///< absent where nobody can know which values are good ones
  std::uint64_t kept = 0;                     ///< points that the filter keeps
  std::uint64_t points = 0;                   ///< of the scan
  std::string reason;  ///< "240 of 786 points (30.5 %) have a confidence of 0, where others have up to 2"

  /// As a configuration has it: "field: {name: confidence, min: 1}". Needs a filter.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] double share() const {
    return points > 0 ? static_cast<double>(kept) / static_cast<double>(points) : 0;
  }
};

/// False where next to nothing would stay: then the field does not mean what it seems to.
[[nodiscard]] bool leaves_enough(const Worth& worth);

/// Takes away what the filters of `worth` refuse, with corners of a mesh that lose all their triangles. The scan was
/// read with `fields` as ReadOptions::fields.
void leave_out_worthless(RawScan& scan, const std::vector<std::string>& fields, const std::vector<Worth>& worth);
/// The same question of one point, whose values stand at `point` in each of `values`.
[[nodiscard]] bool is_worthless(std::span<const std::span<const float>> values, std::size_t point,
                                const std::vector<std::string>& fields, const std::vector<Worth>& worth);

/// In the order of the tallies.
[[nodiscard]] std::vector<Worth> worth_of(const std::vector<FieldTally>& tallies);

}  // namespace sparsha::pipeline
