// What a path without a hand is traced on: the whole level, or a window of a scene.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/threads/progress.h"
#include "haptics/replay/trace.h"
#include "haptics/surface/monge_surface.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

/// Which surface of a scene.
struct TracedPart {
  int level = -1;                           ///< -1: all of level 0 without a window, unless there is a centre
  std::optional<Eigen::Vector2d> centre_m;  ///< of the window, grid frame; absent: the level's middle
  bool texture = true;                      ///< false: the envelope
  bool friction = true;
  double tip_radius_m = 0.0;           ///< of the ball that touches, device frame; 0: a point
  const Progress* progress = nullptr;  ///< may cancel; null: nobody does
};

/// Throws Error{usage} for a level that is not there or is a single row, and for a window that holds nothing;
/// Error{input} when tiles cannot be read.
[[nodiscard]] std::shared_ptr<const MongeSurface> traced_surface(const scene::Scene& scene, const TracedPart& part);

/// The frame that a path is given in. `device`: relative to the window's centre, at the size of the workspace.
enum class HipFrame { grid, scan, device };

/// A place of the hand in the grid frame.
[[nodiscard]] Eigen::Vector3d in_grid_frame(const Eigen::Vector3d& position_m, HipFrame frame,
                                            const Eigen::Matrix4d& grid_from_scan, const MongeSurface& surface);
void to_grid_frame(std::vector<HipSample>& path, HipFrame frame, const scene::SceneDescription& scene,
                   const MongeSurface& surface);

}  // namespace sparsha::haptics
