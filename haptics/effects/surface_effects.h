// What a surface carries besides its shape and friction: impact and grain, which are invented, and the parts of the
// scene that have a stiffness or a material of their own.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "haptics/effects/grain.h"
#include "scene/area/area.h"
#include "scene/area/region_frame.h"
#include "scene/config/cues.h"
#include "scene/depth_grid.h"
#include "scene/material/materials.h"

namespace sparsha::haptics {

/// Immutable; made off the servo thread, read by it. Places are in the frame that parts are written in.
struct SurfaceEffects {
  static constexpr std::size_t kNoPart = static_cast<std::size_t>(-1);
  struct Part {
    scene::Area area;
    std::optional<double> stiffness_n_per_m;
    std::optional<scene::Material> material;
  };
  bool impact = false;
  bool grain = false;
  scene::Material material = scene::Material::granite;             ///< where no part has its own
  std::vector<Part> parts;                                         ///< the first that has a value gives it
  double border_m = 0.0;                                           ///< over which a part's values fade in
  double scale = 1.0;                                              ///< device metres per metre of this frame
  Eigen::Matrix3d region_from_grid = Eigen::Matrix3d::Identity();  ///< rotation
  scene::GrainField field;
  std::optional<scene::CuesConfig> cues;  ///< absent: none
  std::vector<scene::Area> part_areas{};  ///< with cues: of all parts, in their order
  scene::Lattice stone_lattice{};         ///< of stone_m: the window
  std::vector<float> stone_m{};  ///< from each node to the nearest one that is known, grid frame; empty: not measured
  std::vector<float> stone_height_m{};  ///< with stone_m: of the stone as it is continued over unknown ground, above
                                        ///< stone_lattice's origin

  [[nodiscard]] bool has_stiffness() const noexcept;
  /// `base_n_per_m` outside of the parts, a smooth step across their borders.
  [[nodiscard]] double stiffness_at(const Eigen::Vector3d& place_m, double base_n_per_m) const noexcept;
  [[nodiscard]] const scene::MaterialTouch& material_at(const Eigen::Vector3d& place_m) const noexcept;
  /// Of part_areas, the first that holds the place; else kNoPart.
  [[nodiscard]] std::size_t part_at(const Eigen::Vector3d& place_m) const noexcept;
  /// Across, from a place (grid frame) to the stone, grid metres; 0 where there is stone or nothing is known of it.
  [[nodiscard]] double to_stone_m(double x_m, double y_m) const noexcept;
  /// z (grid frame) of the stone where the nearest node of the window has it, or of the stone around it. Requires
  /// stone_m.
  [[nodiscard]] double stone_z_m(double x_m, double y_m) const noexcept;
  /// Of the grain's heights; likewise smooth.
  [[nodiscard]] double grain_gain_at(const Eigen::Vector3d& place_m) const noexcept;
};

/// From each node to the nearest known one, in metres, along the lattice's eight directions: at most 8 % too far. Where
/// no node is known, the window's longer side.
[[nodiscard]] std::vector<float> distance_to_stone(const scene::DepthGrid& grid);

}  // namespace sparsha::haptics
