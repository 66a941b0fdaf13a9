#include "pipeline/build/point_worth.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "pipeline/filter/filter.h"
#include "pipeline/scan/worth.h"

namespace sparsha::pipeline {
namespace {

bool has_field(const std::vector<std::string>& names, const std::string& key) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return field_key(name) == key; });
}

}  // namespace

void require_fields(const std::vector<scene::ScanConfig>& configs, const ScanSet& scans,
                    const std::vector<scene::FilterConfig>& filters, Progress& progress) {
  for (const scene::FilterConfig& filter : filters) {
    const std::string key = field_of(filter);
    if (key.empty() || (key == kIntensityField && scans.has_intensity())) continue;
    std::vector<std::string> names;
    std::string without;
    std::size_t with = 0;
    for (std::size_t s = 0; s < configs.size(); ++s) {
      for (const std::string& name : scans.fields_of(s)) {
        const std::string known = field_key(name);
        if (!has_field(names, known) && (known == kIntensityField || !is_known_otherwise(known))) names.push_back(name);
      }
      if (has_field(scans.fields_of(s), key)) {
        ++with;
      } else {
        without += (without.empty() ? "" : ", ") + configs[s].file.string();
      }
    }
    if (with == 0) {
      throw Error(ErrorKind::input, filter.place, fmt::format("no scan has the field '{}'", key),
                  names.empty() ? "scans with that field; these have none that tells more than place and colour"
                                : fmt::format("one of {}", fmt::join(names, ", ")));
    }
    if (!without.empty()) {
      progress.warn(fmt::format("{}: has no field '{}'; the filter '{}' keeps all points of it", without, key,
                                scene::filter_name(filter)));
    }
  }
}

void warn_of_unused_worth(const std::vector<scene::ScanConfig>& configs, const ScanSet& scans,
                          const std::vector<scene::FilterConfig>& filters, Progress& progress) {
  const auto is_used = [&](const std::string& key) {
    return std::any_of(filters.begin(), filters.end(),
                       [&](const scene::FilterConfig& f) { return field_of(f) == key; });
  };
  for (std::size_t s = 0; s < configs.size(); ++s) {
    for (const Worth& worth : worth_of(scans.tallies_of(s))) {
      if (is_used(worth.field)) continue;
      progress.warn(configs[s].file.string() + ": " + worth.reason +
                    (worth.filter ? ", and are used like all others; the filter '" + worth.text() + "' leaves them out"
                                  : ", which is not used; a filter 'field' can leave points out by it"));
    }
  }
}

}  // namespace sparsha::pipeline
