// Heights along a line across a scene, at the finest level, for measures and files.
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"
#include "viewer/marks/notes.h"

namespace sparsha::viewer {

struct ProfileSample {
  double along_m = 0.0;                                ///< from the first end, across the grid
  Eigen::Vector3d at_m;                                ///< grid frame; z is NaN where nothing is known
  scene::NodeState state = scene::NodeState::unknown;  ///< of the worst of the cell's nodes
};

/// Height of level 0's bilinear surface, grid frame; NaN outside the lattice and where a corner of the cell is unknown.
/// Reads four nodes. Throws Error{input} on unreadable tiles.
[[nodiscard]] double surface_height_m(const scene::Scene& scene, double x_m, double y_m);

/// Samples of level 0's bilinear surface from `from_m` to `to_m` (x and y count), one a spacing, at most 20 000 and at
/// least two. Reads along the line only, piece by piece. Throws Error{input} on unreadable tiles.
[[nodiscard]] std::vector<ProfileSample> profile_along(const scene::Scene& scene, const Eigen::Vector3d& from_m,
                                                       const Eigen::Vector3d& to_m);

/// along_m,x_m,y_m,z_m,state; atomically. Unknown heights are empty. Throws Error{failure}.
void write_profile(const std::vector<ProfileSample>& profile, const std::filesystem::path& file);
/// kind,value,unit and three points, x y z each; atomically. Throws Error{failure}.
void write_measures(const std::vector<Measure>& measures, const std::filesystem::path& file);

}  // namespace sparsha::viewer
