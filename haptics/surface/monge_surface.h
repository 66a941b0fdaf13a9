// The surface of one haptic window: z = f(x, y), bilinear in every cell, with a height at every node.
// Coordinates are local: metres relative to node (0,0) and height zero of the window's lattice.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "scene/config/haptics.h"
#include "scene/depth_grid.h"

namespace sparsha {
class Progress;
}

namespace sparsha::haptics {

/// Bits per cell, for State::flags.
enum CellFlag : std::uint8_t { kCellFilled = 1, kCellUnknown = 2, kCellOutside = 4 };

struct SurfaceEffects;

/// Immutable; made off the servo thread, read by it. Beyond its border the surface goes on level and frictionless.
struct MongeSurface {
  scene::Lattice lattice;                ///< of the window, grid frame
  std::vector<float> height_m;           ///< every node known: holes and the outside continue the nearest edge smoothly
  std::vector<float> mu_dynamic;         ///< per node, 0 on unknown nodes; empty: frictionless
  std::vector<float> mu_static;          ///< per node, >= mu_dynamic; empty when mu_dynamic is
  std::vector<std::uint8_t> cell_flags;  ///< (nx-1)*(ny-1) CellFlag bits; empty: none set
  std::uint64_t id = 0;
  int level = 0;
  double scale = 1.0;         ///< device metres per grid metre
  double tip_radius_m = 0.0;  ///< device frame; heights are a ball's, lowered by it
  scene::HapticsConfig::Beyond beyond = scene::HapticsConfig::Beyond::continued;  ///< outlines
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();          ///< grid point at the device frame's origin
  double highest_m = std::numeric_limits<double>::infinity();  ///< no node is higher; above it nothing is searched
  std::shared_ptr<const SurfaceEffects> effects;               ///< haptics/effects; null: none

  [[nodiscard]] double width_m() const { return (lattice.nx - 1) * lattice.spacing_m; }
  [[nodiscard]] double depth_m() const { return (lattice.ny - 1) * lattice.spacing_m; }
  /// Bilinear height at local (x, y), clamped to the window; NaN where x or y is NaN. Local frame, metres.
  [[nodiscard]] double height(double x, double y) const noexcept;
};

/// Coefficients per node; both empty: frictionless.
struct FrictionMap {
  std::vector<float> mu_dynamic;
  std::vector<float> mu_static;  ///< not below mu_dynamic
};

/// What a surface is made of.
struct SurfaceParts {
  scene::Lattice lattice;       ///< at least 2 x 2 nodes
  std::vector<float> height_m;  ///< per node, row 0 at the bottom, relative to lattice.origin_m.z; NaN: unknown
  FrictionMap friction;         ///< per node or empty
  std::vector<std::uint8_t> cell_flags;  ///< (nx-1)*(ny-1) CellFlag bits; empty: kCellUnknown where a node is unknown
  double scale = 1.0;                    ///< device metres per grid metre
  double tip_radius_m = 0.0;             ///< of the ball that touches, device frame; 0: a point
  scene::HapticsConfig::Beyond beyond = scene::HapticsConfig::Beyond::continued;  ///< outlines
  double hole_m = 0.0;  ///< grid frame; what is narrower is continued in any case (scene/ground/beyond.h)
  int margin = 0;       ///< height_m reaches so many nodes beyond the lattice on every side, for the ball to touch
  int level = 0;
  std::uint64_t id = 0;
  std::optional<Eigen::Vector3d> centre_m;        ///< grid frame; absent: the surface in the window's middle
  std::shared_ptr<const SurfaceEffects> effects;  ///< may be null
  const Progress* progress = nullptr;             ///< may cancel the making; null: nobody does
};

/// Nodes beyond a window that a ball over its border can touch.
[[nodiscard]] int margin_of(double tip_radius_m, double scale, double spacing_m);

/// Makes the surface; unknown heights are continued, or fall away beyond outlines. Off the servo thread. Throws
/// Error{failure} when sizes do not match the lattice, or lattice and scale are not positive and finite, and Cancelled.
[[nodiscard]] std::shared_ptr<const MongeSurface> make_surface(SurfaceParts parts);

}  // namespace sparsha::haptics
