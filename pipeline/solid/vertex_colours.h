// Scan colours of a closed mesh's vertices.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// Whether the scans had colours and the scene keeps them.
[[nodiscard]] bool has_colours(const scene::Charts& charts);

/// A colour 0xAABBGGRR for each vertex (grid frame, metres from the charts' origin): of the nearest node that has one
/// within two spacings, with those as near as it to a third of a spacing; 0 where there is none, as over holes of the
/// scan. Requires has_colours(). Depends on no threads.
[[nodiscard]] std::vector<std::uint32_t> vertex_colours(const scene::Charts& charts,
                                                        const std::vector<Eigen::Vector3f>& vertices_m,
                                                        const Context& context);

}  // namespace sparsha::pipeline
