// `sparsha device emulate`.
#pragma once

#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "base/error.h"

namespace sparsha::app {

void add_emulate(Command device, const CommonOptions& common, Run& run);

/// Applies each named one of `faults` (records with `name` and `apply`) to `target`. Throws Error{usage} for a name
/// that none has, with those that there are.
template <typename Faults, typename Target>
void apply_faults(const Faults& faults, const std::vector<std::string>& names, Target& target) {
  for (const std::string& name : names) {
    std::string known;
    bool found = false;
    for (const auto& fault : faults) {
      known += (known.empty() ? "" : " | ") + std::string(fault.name);
      if (fault.name != name) continue;
      fault.apply(target);
      found = true;
    }
    if (!found) throw usage_error("there is no fault '" + name + "'", known);
  }
}

}  // namespace sparsha::app
