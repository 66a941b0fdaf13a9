// A whole object as a solid to be printed and held.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/threads/context.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// What a person who prints it should know. In print the object stands upright: z is the grid's y.
struct WholeReplicaReport {
  double width_mm = 0.0, depth_mm = 0.0, height_mm = 0.0;
  double scale = 0.0;       ///< print over object
  double spacing_mm = 0.0;  ///< of the nodes in print
  double volume_mm3 = 0.0;  ///< enclosed
  std::uint64_t triangles = 0;
  std::uint32_t shells = 0;           ///< separate closed surfaces
  double unseen = 0.0;                ///< share of the surface that closes holes of the scan
  std::vector<std::string> warnings;  ///< each with what to do
};

/// Writes the closed mesh of all charts as FILE.stl (binary) or FILE.3mf, its longest side `longest_mm`, standing on
/// z = 0 in the middle of x and y. Atomic; millimetres. Requires a scene with charts. Throws Error{usage} for a size
/// out of 20 to 2000 mm, and as make_closed_mesh() does.
WholeReplicaReport export_whole_replica(const scene::Scene& scene, const std::filesystem::path& file, double longest_mm,
                                        const Context& context);

}  // namespace sparsha::pipeline
