// A whole object as triangles with everything that light needs at each vertex, in levels of detail.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "scene/charts.h"

namespace sparsha::viewer {

/// Triangles of one level, counterclockwise as seen from outside. Lengths in spacings of the charts, relative to their
/// origin, axes of the grid frame.
struct ObjectMesh {
  /// Triangles of one block of space.
  struct Chunk {
    Eigen::Vector3f low, high;
    std::uint32_t first = 0;  ///< into `indices`
    std::uint32_t count = 0;
  };
  std::vector<Eigen::Vector3f> place;
  std::vector<Eigen::Vector3f> normal;     ///< unit, outward
  std::vector<float> sky;                  ///< share of an even sky all around that the vertex sees, 0 to 1
  std::vector<float> curvature;            ///< mean of the normal curvatures, per spacing; ridges positive
  std::vector<bool> measured;              ///< of the finest level; else it continues the sheet or closes a small hole
  std::vector<float> texture_m;            ///< of the finest level, where the charts have it; NaN: not known
  std::vector<float> bend_per_m;           ///< likewise: curvature of the texture
  std::vector<std::uint32_t> colour_rgba;  ///< likewise: 0xAABBGGRR as scanned; 0: not known
  std::vector<float> intensity;            ///< likewise, as scanned
  std::vector<float> error_m;              ///< likewise: mean distance of the scans' points
  std::vector<std::uint32_t> indices;      ///< three a triangle
  std::vector<std::uint32_t>
      coarser;  ///< of each vertex: the next level's vertex that stands for it; empty on the last
  std::vector<Chunk> chunks;
  double spacing = 1.0;  ///< typical distance of vertices
};

/// What is drawn of charts. Level 0 has every node that is drawn, each next one about a quarter of the vertices; the
/// last one has few thousand. Empty without cells. Independent of the number of threads. Cost: about 2 us per node and
/// thread.
[[nodiscard]] std::vector<ObjectMesh> make_object_meshes(const scene::Charts& charts, ThreadPool& pool);

/// Share of an even sky, 0 to 1, that each of `mesh`'s vertices sees, weighted by the cosine to its normal. What covers
/// the sky are `blockers`' vertices, as dense as they are.
[[nodiscard]] std::vector<float> sky_over(const ObjectMesh& mesh, const ObjectMesh& blockers, ThreadPool& pool);

}  // namespace sparsha::viewer
