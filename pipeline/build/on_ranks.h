// What is not built by several processes together.
#pragma once

#include <cstddef>

#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Before anything is read: throws Error{usage} that names the first block or filter of the configuration which is
/// built by one process only.
void require_fit_for_ranks(const scene::Config& config);

/// After the scans have been looked at: throws Error{usage} when there are triangles among them.
void require_points_for_ranks(const scene::Config& config, std::size_t faces);

}  // namespace sparsha::pipeline
