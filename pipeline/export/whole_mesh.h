// The closed mesh of a whole object in the scan's own frame.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/solid/closed_mesh.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Whether a name's ending is that of a mesh: .ply, .obj or .glb.
[[nodiscard]] bool is_mesh(const std::filesystem::path& file);

struct WholeMesh {
  std::vector<Eigen::Vector3d> places_m;                ///< of the vertices
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise as seen from outside
  std::vector<std::uint32_t> colours;                   ///< 0xAABBGGRR, 0: none; empty or one a vertex
  ClosedMeshFacts facts;
};
/// One mesh made of all charts, in the frame of the scans. Requires a scene with charts. Throws as make_closed_mesh().
[[nodiscard]] WholeMesh whole_mesh(const scene::Scene& scene, Holes holes, const Context& context);

/// Writes that mesh. Atomic. Requires a scene with charts. Throws Error{usage} for another ending,
/// and as make_closed_mesh() does.
ClosedMeshFacts export_whole_mesh(const scene::Scene& scene, const std::filesystem::path& file, Holes holes,
                                  const Context& context);

}  // namespace sparsha::pipeline
