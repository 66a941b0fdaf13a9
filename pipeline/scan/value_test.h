// Filters that look at what a scan says of a point and not at its place.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/scan/cloud.h"
#include "pipeline/scan/fields.h"
#include "scene/config/filters.h"

namespace sparsha::pipeline {

/// The field that a filter looks at, as field_key() gives it.
[[nodiscard]] inline std::string field_of(const scene::FieldConfig& field) { return field_key(field.name); }
[[nodiscard]] inline std::string field_of(const scene::ClassesConfig& /*classes*/) { return PointField::kClass; }

/// Points of which the scan says no value (NaN) stay. Limits are rounded as values are: 0.1 is not below 0.1.
[[nodiscard]] inline bool keeps(const scene::FieldConfig& field, float value) {
  return std::isnan(value) || (value >= static_cast<float>(field.min) && value <= static_cast<float>(field.max));
}
[[nodiscard]] inline bool keeps(const scene::ClassesConfig& classes, float value) {
  const std::vector<int>& listed = classes.keep.empty() ? classes.drop : classes.keep;
  const bool is_listed =
      std::any_of(listed.begin(), listed.end(), [&](int c) { return static_cast<float>(c) == value; });
  return std::isnan(value) || is_listed != classes.keep.empty();
}

}  // namespace sparsha::pipeline
