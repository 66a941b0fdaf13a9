// The configuration's block `parts`: places that have a name, and how they are touched.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/material/materials.h"

namespace sparsha::scene {

/// How a part is touched where it differs from the rest of the scene.
struct PartTouch {
  std::optional<double> stiffness_n_per_m;
  std::optional<double> mu_dynamic;
  std::optional<double> mu_static;  ///< without it the larger of mu_dynamic and the scene's mu_static
  std::optional<Material> material;
};

/// It lies in the box, or, where one of these is there, in the polygon, in the box in space or where the label image
/// has the label.
struct PartConfig {
  std::string name;
  std::string say;
  std::array<double, 4> box_m{};  ///< xmin ymin xmax ymax, grid frame; zeros with a polygon or a label
  PartTouch touch{};
  std::string more{};                              ///< told when more is asked for
  std::vector<std::array<double, 2>> polygon_m{};  ///< corners, grid frame; empty: none
  std::optional<int> label{};                      ///< of the label image, AudioConfig::labels
  std::optional<std::array<double, 6>> solid_m{};  ///< xmin ymin zmin xmax ymax zmax, frame of the scans
  [[nodiscard]] bool is_box() const { return polygon_m.empty() && !label && !solid_m; }
};

}  // namespace sparsha::scene
