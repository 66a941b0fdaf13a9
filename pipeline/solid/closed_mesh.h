// One closed mesh of a whole object from its charts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// What a closed mesh is, and what was found on the way.
struct ClosedMeshFacts {
  double area_m2 = 0.0;
  double volume_m3 = 0.0;    ///< enclosed, holes being closed
  double closing_m2 = 0.0;   ///< of the area, what closes holes of the scan
  std::uint32_t shells = 0;  ///< separate closed surfaces
  std::uint32_t crumbs = 0;  ///< shells smaller than a ball of 2 spacings radius, which were left out

  /// Of the area, 0 to 1, what no scan saw.
  [[nodiscard]] double unseen() const { return area_m2 > 0.0 ? closing_m2 / area_m2 : 0.0; }
};

/// Triangles counter-clockwise as seen from outside. Each edge belongs to two triangles that pass it in opposite
/// directions; where holes are left open, edges at the borders of the scan belong to one.
struct ClosedMesh {
  std::vector<Eigen::Vector3f> vertices_m;  ///< grid frame, relative to the charts' origin
  std::vector<std::array<std::uint32_t, 3>> triangles;
  ClosedMeshFacts facts;
};

enum class Holes : std::uint8_t { close, leave };

/// The nodes of the charts are vertices. Between sheets and over holes the surface is where the winding number of all
/// nodes is a half. Edges sharper than the spacing are cut off by up to about half of it. Neither threads nor anything
/// but the charts changes a bit. Throws Error{input} when the charts enclose nothing, or nearly half of the closed
/// surface would be made up; Error{usage} when the object is too large for its spacing.
[[nodiscard]] ClosedMesh make_closed_mesh(const scene::Charts& charts, Holes holes, const Context& context);

}  // namespace sparsha::pipeline
