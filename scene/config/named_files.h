// The files that a configuration reads, for all who write others.
#pragma once

#include <vector>

#include "base/files/files.h"
#include "scene/config/config.h"

namespace sparsha::scene {

/// Scans, clips and the label image, each with what messages call it.
[[nodiscard]] std::vector<NamedPath> named_files(const Config& config);

}  // namespace sparsha::scene
