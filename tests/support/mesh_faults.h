// What is wrong with a triangle mesh that should be a closed surface. Shares no code with what makes meshes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace sparsha::test {

struct MeshFaults {
  std::size_t open_edges = 0;  ///< of one triangle
  std::size_t bad_edges = 0;   ///< of more than two, or of two that pass it in the same direction
  std::size_t pinched = 0;     ///< vertices whose triangles are not one fan
  std::size_t flat = 0;        ///< triangles without an area
  std::size_t crossings = 0;   ///< pairs of triangles without a common vertex that pass through each other
  long euler = 0;              ///< vertices - edges + triangles
};
[[nodiscard]] MeshFaults find_mesh_faults(const std::vector<Eigen::Vector3f>& vertices,
                                          const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sparsha::test
