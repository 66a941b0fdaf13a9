// Parts that are spoken of and regions that sound: where they are, also after the object was turned.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "scene/area/area.h"
#include "scene/area/region_frame.h"
#include "scene/config/parts.h"
#include "scene/scene_fwd.h"

namespace sparsha::scene {

/// The scene's label image, read when nobody did before; null without one. Without `bounds_m` it lies over level 0.
/// Throws Error{input} for a file that cannot be read.
[[nodiscard]] std::shared_ptr<const LabelMap> label_map_of(const SceneDescription& scene);

/// Makes `part_areas` of the parts, and reads the label image where parts have labels; what was made of the same
/// corners and labels before is kept. Whoever makes a Scene does so; throws Error{input} as label_map_of().
void make_areas(SceneDescription& scene);

/// Where a part lies, in the frame that parts are written in. Of the description of a Scene it is at hand; of another
/// polygons are made ready at every call, and labels are nowhere before make_areas().
[[nodiscard]] Area area_of(const SceneDescription& scene, std::size_t part);

/// A box in space, xmin ymin zmin xmax ymax zmax of the frame of the scans, as an area of the regions' frame.
[[nodiscard]] Area solid_area(const SceneDescription& scene, const std::array<double, 6>& box_m);

/// The first part at a place of the regions' frame; null where there is none.
[[nodiscard]] const PartConfig* part_at(const SceneDescription& scene, const std::array<double, 3>& place_m);

/// Where a part is shown, and where a hand is led that looks for it.
struct PartPlace {
  std::array<double, 4> box_m{};                       ///< xmin ymin xmax ymax, grid frame
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();  ///< grid frame; of a box its middle, else a place inside
  /// Of a part in a box in space, by the nodes of all sheets in it; grid frame.
  struct Solid {
    Eigen::Vector3d middle_m;
    Eigen::Vector3d normal;  ///< sum of the outward ones: where it looks
    double size_m;           ///< across
  };
  std::optional<Solid> solid{};
};

/// Of the nodes of all sheets that lie in a box in space; empty when there are none.
[[nodiscard]] std::optional<PartPlace> solid_place(const SceneDescription& scene, const SolidBox& solid);

/// A part's own place in the grid frame, or, of a scene that was scanned from another side, that of the measured places
/// that belong to it; empty when there are none. Throws Error{input} when tiles cannot be read.
[[nodiscard]] std::optional<PartPlace> part_place(const Scene& scene, std::size_t part);
/// Of it the box alone.
[[nodiscard]] std::optional<std::array<double, 4>> part_box(const Scene& scene, std::size_t part);

}  // namespace sparsha::scene
