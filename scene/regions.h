// Parts that are spoken of and regions that sound: where they are, also after the object was turned.
#pragma once

#include <array>
#include <optional>

#include "scene/region_frame.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

/// `box_m`: xmin ymin xmax ymax, borders included.
[[nodiscard]] inline bool in_box(const std::array<double, 4>& box_m, double x_m, double y_m) {
  return x_m >= box_m[0] && y_m >= box_m[1] && x_m <= box_m[2] && y_m <= box_m[3];
}

/// The first part at a place of the regions' frame; null where there is none.
[[nodiscard]] inline const PartConfig* part_at(const SceneDescription& scene, const std::array<double, 3>& place_m) {
  for (const PartConfig& part : scene.config.parts) {
    if (in_box(part.box_m, place_m[0], place_m[1])) return &part;
  }
  return nullptr;
}

/// Where a part lies in the grid frame, xmin ymin xmax ymax: its own box, or, of a scene that was scanned from another
/// side, the box of the measured places that belong to it; empty when there are none.
[[nodiscard]] std::optional<std::array<double, 4>> part_box(const Scene& scene, const PartConfig& part);

}  // namespace sparsha::pipeline
