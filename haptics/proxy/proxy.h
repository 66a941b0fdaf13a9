// The point proxy on a Monge surface: where a fingertip would rest (docs/touch.md, "Proxy").
// Everything here is in the surface's local frame, metres, and runs on the servo thread: no allocation, no locks, no
// exceptions.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "haptics/surface/monge_surface.h"
#include "scene/config/haptics.h"

namespace sparsha::haptics {

/// The proxy's place by cell and share of a cell, in cells; finer than metres can be far from the origin.
struct ProxyCell {
  std::int32_t i = 0;
  std::int32_t j = 0;
  double s = 0.0;
  double t = 0.0;
  double z = 0.0;
  double spacing_m = 0.0;  ///< for which cells_per_m is kept: a tick does without the division
  double cells_per_m = 0.0;
};

/// What friction on smooth surfaces needs to follow the hand's way within a tick: local frame, metres. Used as long as
/// the state's proxy is at `proxy`.
struct HandTrack {
  Eigen::Vector3d proxy = Eigen::Vector3d::Zero();
  Eigen::Vector3d hand = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double turn_per_m = 0.0;  ///< of the normal, radians, on the hand's way
  bool known = false;
};

/// What carries over from tick to tick. Set `position` and `contact` to move a proxy by hand, e.g. to another surface;
/// a position below the surface is lifted onto it at the next update.
struct ProxyState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  bool contact = false;
  bool sticking = false;
  ProxyCell cell;   ///< the solvers' own; used as long as it agrees with `position`
  HandTrack track;  ///< the exact solver's own
};

/// What one update found.
struct ProxyUpdate {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit; zero when free
  double mu_dynamic = 0.0;
  double mu_static = 0.0;
  bool contact = false;
  bool sticking = false;
  bool unfinished = false;    ///< segment limit reached; goes on next tick
  std::int32_t segments = 0;  ///< cells and pieces visited
  std::uint8_t cell_flags = 0;
};

/// What lies between the nodes: bilinear cells with creases between them, bicubic patches through the nodes, or the
/// bilinear surface with its creases rounded by the uniform cubic B-spline (haptics/proxy/bicubic_patch.h).
enum class CellShape { bilinear, c1, rounded };

/// What the configuration asks for; a path without a hand is traced on sharp creases unless its caller says otherwise.
[[nodiscard]] CellShape shape_of(scene::HapticsConfig::Surface surface, scene::HapticsConfig::Creases creases) noexcept;

/// Moves a proxy to another place, maybe of another surface, and the hand that it knows of with it; lengths become
/// `share` times as long.
void move_proxy(ProxyState& state, const Eigen::Vector3d& position, double share) noexcept;

struct SolverOptions {
  double tolerance_cells = 1e-9;  ///< rest tolerance, of a cell
  int segment_limit = 4000;
  double paper_rho = 0.5;                 ///< the paper's solver: step factor
  int paper_iterations = 100;             ///< and iterations per tick
  CellShape shape = CellShape::bilinear;  ///< the exact solver's; the paper's is bilinear always
  /// The exact solver's: where false, a proxy that leaves the surface stays where it does, free and unfinished.
  bool flies = true;
};

/// Height of the surface that the exact solver touches at local (x, y).
[[nodiscard]] double touched_height(const MongeSurface& surface, double x_m, double y_m, CellShape shape) noexcept;

/// Starts at or above the HIP at height max(z, f).
[[nodiscard]] ProxyState start_proxy(const MongeSurface& surface, const Eigen::Vector3d& hip) noexcept;

/// The exact active-set solver. A HIP that is not finite, or 1e12 cells away, leaves the state as it was and reports no
/// contact.
[[nodiscard]] ProxyUpdate update_exact(const MongeSurface& surface, const Eigen::Vector3d& hip, ProxyState& state,
                                       const SolverOptions& options) noexcept;

/// The source paper's iteration (Aniyath et al., eq. 1 to 6).
[[nodiscard]] ProxyUpdate update_paper(const MongeSurface& surface, const Eigen::Vector3d& hip, ProxyState& state,
                                       const SolverOptions& options) noexcept;

}  // namespace sparsha::haptics
