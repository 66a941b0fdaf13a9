// The one friction law: what is felt, shown and reported of a scene's friction.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "scene/area/area.h"
#include "scene/config/layers.h"
#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// Friction coefficients of nodes from the scene's curvature layers.
/// law curvature: mu_d = clamp(mu_0 + c k, 0, mu_max), k in scene units, so that zoom does not change the stone.
/// law paper: mu_d = 1 / (R sqrt(H^2 + K^2)) clamped to [0, mu_max] (Aniyath et al., eq. 7 to 9), curvatures at the
/// window's scale, R = half the workspace's width, metres. law constant: mu_0. Where the curvature is not known, near
/// steps and holes or because the scene has no such layer, mu_d is mu_0 (law curvature and paper), within [0, mu_max].
/// A part's own coefficients stand above the law; the first part that has some wins, with a soft border (kBorder_m).
class FrictionLaw {
 public:
  /// `scale`: device metres a grid metre. Requires a scene with a friction block; it outlives the law.
  FrictionLaw(const SceneDescription& scene, double scale, double workspace_m);

  /// mu_d at a node of `layers`, whether or not its height is known.
  [[nodiscard]] float dynamic(const Layers& layers, std::size_t node) const;
  /// mu_s at a node where mu_d is `dynamic`: never less.
  [[nodiscard]] float at_rest(const Layers& layers, std::size_t node, float dynamic) const;

  struct Coefficients {
    float mu_dynamic, mu_static;
  };
  /// At a place (grid frame) on any side of the object, where the texture bends so much; NaN: not known. Law paper is
  /// of one view: mu_0.
  [[nodiscard]] Coefficients at(const Eigen::Vector3d& place_m, double curvature_per_m) const;

 private:
  struct Part {
    Area area;
    double mu_dynamic;
    double mu_static;
  };
  [[nodiscard]] double of_curvature(double curvature_per_m) const;
  [[nodiscard]] Eigen::Vector3d place_of(const Layers& layers, std::size_t node) const;
  [[nodiscard]] double with_parts(const Eigen::Vector3d& place_m, double mu, double Part::*own) const;

  const FrictionConfig& config_;
  double c_m_;
  double scale_;
  double radius_m_;
  const SceneDescription& scene_;
  std::vector<Part> parts_;  // that have friction of their own
};

}  // namespace sparsha::scene
