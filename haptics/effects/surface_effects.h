// What a surface carries besides its shape and friction: impact and grain, which are invented, and the parts of the
// scene that have a stiffness or a material of their own.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "haptics/effects/grain.h"
#include "scene/materials.h"
#include "scene/region_frame.h"

namespace sparsha::haptics {

/// Immutable; made off the servo thread, read by it. Places are in the frame that parts are written in.
struct SurfaceEffects {
  struct Part {
    std::array<double, 4> box_m{};  ///< xmin ymin xmax ymax
    std::optional<double> stiffness_n_per_m;
    std::optional<pipeline::Material> material;
  };
  bool impact = false;
  bool grain = false;
  pipeline::Material material = pipeline::Material::granite;       ///< where no part has its own
  std::vector<Part> parts;                                         ///< the first that has a value gives it
  double border_m = 0.0;                                           ///< over which a part's values fade in
  double scale = 1.0;                                              ///< device metres per metre of this frame
  Eigen::Matrix3d region_from_grid = Eigen::Matrix3d::Identity();  ///< rotation
  pipeline::GrainField field;

  [[nodiscard]] bool has_stiffness() const noexcept;
  /// `base_n_per_m` outside of the parts, a smooth step across their borders.
  [[nodiscard]] double stiffness_at(double x_m, double y_m, double base_n_per_m) const noexcept;
  [[nodiscard]] const pipeline::MaterialTouch& material_at(double x_m, double y_m) const noexcept;
  /// Of the grain's heights; likewise smooth.
  [[nodiscard]] double grain_gain_at(double x_m, double y_m) const noexcept;
};

}  // namespace sparsha::haptics
