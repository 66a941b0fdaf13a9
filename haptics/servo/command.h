// What the session tells the servo, through a bounded lock-free queue.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "haptics/guide/guide_path.h"
#include "haptics/state/spsc_queue.h"
#include "haptics/surface/monge_surface.h"
#include "scene/area/region_frame.h"

namespace sparsha::haptics {

struct ObjectSurface;

using SurfacePointer = std::shared_ptr<const MongeSurface>;

/// Which surface effects are rendered.
struct Effects {
  bool texture = true;   ///< false: the envelope
  bool friction = true;  ///< false: mu = 0 everywhere
};

/// The surface that is touched, and which nodes of which level it is.
struct HapticWindow {
  SurfacePointer surface;
  /// The whole object, which is touched instead of the surface; it lives as long as `surface`, which then gives the
  /// scale alone. Null: one view.
  const ObjectSurface* object = nullptr;
  int i0 = 0;  ///< of the level's lattice; nodes [i0, i0 + lattice.nx) x [j0, j0 + lattice.ny)
  int j0 = 0;
  int level_nx = 0;  ///< of the whole level; 0 = the window is all there is
  int level_ny = 0;
  std::uint64_t id = 0;     ///< counts swaps of window, level or scene
  std::uint64_t scene = 1;  ///< counts the scenes that the session was given
  Effects effects;
  bool turned = false;  ///< the scene's parts and sounds are written in another frame:
  scene::RegionFrame region_from_grid = scene::RegionFrame::Identity();
};

struct Command {
  enum class Kind {
    swap,       ///< touch `window`; the hand keeps its place; with `on` the whole object is turned to `turn` too
    scroll,     ///< let the window's centre move with `scroll_m_per_s` until told otherwise
    stiffness,  ///< render with `stiffness_n_per_m`
    guide,      ///< lead the hand along `guide`; null: no longer
    turn,       ///< a whole object is turned to `turn`, and let go of first
    drag,       ///< `on`: the window's centre moves with the hand, and nothing is touched, until told otherwise
  };
  Kind kind = Kind::scroll;
  HapticWindow window;
  bool move = false;                                   ///< swap: the new centre is `centre_m`, not the one that
                                                       ///< keeps the proxy's point of the scene under the hand
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  ///< grid frame
  double centre_z_m = std::numeric_limits<double>::quiet_NaN();  ///< of a whole object; not finite: as it was
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();      ///< from the grid frame's axes to the device frame's
  Eigen::Vector3d scroll_m_per_s = Eigen::Vector3d::Zero();      ///< grid frame; never downwards in contact
  double stiffness_n_per_m = 0.0;
  std::shared_ptr<const Guide> guide;  ///< whoever gives it keeps a share, so that the servo never frees it
  bool on = false;
  std::uint64_t sequence = 0;  ///< counts commands from 1
};

using CommandQueue = SpscQueue<Command>;
/// Surfaces that the servo no longer needs, to be freed elsewhere.
using RetiredQueue = SpscQueue<SurfacePointer>;

}  // namespace sparsha::haptics
