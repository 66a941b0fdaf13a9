// What is not built by several processes together, and what must be the same on all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/build/build.h"
#include "pipeline/cluster/ranks.h"
#include "scene/scene.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Before anything is read: throws Error{usage} that names the first block or filter of the configuration which is
/// built by one process only.
void require_fit_for_ranks(const scene::Config& config);

/// After the scans have been looked at: throws Error{usage} when there are triangles among them.
void require_points_for_ranks(const scene::Config& config, std::size_t faces);

/// Before anything is read; of all ranks of `options`. Throws Error{usage} in the root, which names a rank that has
/// another configuration, another program or other options that decide the scene; Error{input} for one that has a scan
/// of another size or with other ends at the same path. A scan that a rank cannot read is named by that rank.
void require_same_configuration(const scene::Config& config, const BuildOptions& options);

/// After the scans have been looked at; of all ranks. Throws Error{input} in the root, which names the first scan of
/// which a rank has other bytes or another number of points. `points`, `invalid`: of all scans.
void require_same_scans(const Ranks& ranks, const std::vector<scene::ScanSource>& sources, std::uint64_t points,
                        std::uint64_t invalid);

}  // namespace sparsha::pipeline
