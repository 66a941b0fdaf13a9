// Triangles of a lattice: coarse where the surface is whole, node by node along rims and depth steps, without cracks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "viewer/surface/joints.h"

namespace sparsha::viewer {

/// Indices of one coarseness. An index is a node's storage index, plus the number of nodes where the node is drawn at
/// Joints::far_m.
struct Mesh {
  struct Chunk {
    std::array<int, 4> nodes{};  ///< i0, j0, i1, j1, inclusive
    std::uint32_t first = 0;     ///< into `indices`
    std::uint32_t count = 0;
  };
  std::vector<std::uint32_t> indices;  ///< three a triangle
  std::vector<Chunk> chunks;
};

/// A pyramid over a lattice's cells: level L's cell covers 2^L x 2^L of them.
class CellTree {
 public:
  explicit CellTree(const Joints& joints);
  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }
  /// Whole cells of `level`, divided where they are not whole. `height_m` and `joints` as find_joints() left them.
  [[nodiscard]] Mesh mesh(int level, const Joints& joints, const std::vector<float>& height_m) const;

 private:
  struct Level {
    int nx = 0, ny = 0;  // cells
    std::vector<CellKind> kind;
  };
  class Builder;
  [[nodiscard]] CellKind kind(int level, int i, int j) const;

  std::vector<Level> levels_;
};

}  // namespace sparsha::viewer
