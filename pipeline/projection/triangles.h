// Exact heights of a triangle mesh at the lattice's nodes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/threads/thread_pool.h"
#include "pipeline/projection/bins.h"

namespace sparsha::pipeline {

/// Per node the highest triangle whose projection contains it, edges included.
struct TriangleHeights {
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::vector<float> height_m;      ///< relative to the oriented points' origin; NaN where no triangle is
  std::vector<std::uint32_t> face;  ///< which triangle; kNone where there is none
};

/// A node on an edge belongs to both of its triangles, so that a closed surface has no cracks. Triangles seen edge-on
/// count where they contain a node. A node that no triangle contains belongs to those whose edges it misses by no more
/// than float32 rounds: so the outer row of a mesh made on the lattice keeps its nodes. Of equally high triangles the
/// one with the lowest number is named.
[[nodiscard]] TriangleHeights project_triangles(const OrientedPoints& points,
                                                const std::vector<std::array<std::uint32_t, 3>>& faces,
                                                const BinLattice& lattice, ThreadPool& pool);

}  // namespace sparsha::pipeline
