// The closed mesh of a whole object in the scan's own frame.
#pragma once

#include <filesystem>

#include "base/threads/context.h"
#include "pipeline/solid/closed_mesh.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// Whether a name's ending is that of a mesh: .ply, .obj or .glb.
[[nodiscard]] bool is_mesh(const std::filesystem::path& file);

/// Writes one mesh made of all charts. Atomic. Requires a scene with charts. Throws Error{usage} for another ending,
/// and as make_closed_mesh() does.
ClosedMeshFacts export_whole_mesh(const scene::Scene& scene, const std::filesystem::path& file, Holes holes,
                                  const Context& context);

}  // namespace sparsha::pipeline
