// --set: keys of a configuration that settings override.
#pragma once

#include <string>
#include <vector>

#include "base/yaml/yaml.h"

namespace sparsha::scene {

/// Applies settings such as "grid.size=800". A key of the document that would contradict one of them gives way; two
/// settings that contradict each other both stay, for parse_config to refuse.
void override_keys(yaml::Node& root, const std::vector<std::string>& settings);

}  // namespace sparsha::scene
