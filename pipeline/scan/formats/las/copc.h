// COPC 1.0: a LAZ file whose chunks are the nodes of an octree, so that a box or a coarse look needs some of them only.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/formats/las/laz/chunk_table.h"
#include "pipeline/scan/formats/las/laz/packing.h"

namespace sparsha::pipeline::las {

struct Octree {
  struct Node {
    int level = 0;  ///< 0: the root; points of deeper levels come on top of those above them
    std::array<std::int32_t, 3> cell{};
    laz::Chunk chunk;
  };
  struct Box {
    Eigen::Vector3d low, high;
  };
  Eigen::Vector3d low = Eigen::Vector3d::Zero();   ///< corner of the root's cube, as the file stores coordinates
  double side = 0.0;                               ///< of the root's cube
  double spacing = 0.0;                            ///< of the points of level 0; each level halves it
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  ///< of stored coordinates
  std::vector<Node> nodes;                         ///< those with points, in the file's order

  [[nodiscard]] std::vector<laz::Chunk> chunks() const;  ///< of the nodes, in the file's order
  [[nodiscard]] int levels() const;
  /// The node's cube and one step of the coordinates on each side: writers round points out of their cubes. Its z times
  /// `z_factor`, which may be negative.
  [[nodiscard]] Box box_of(const Node& node, double z_factor = 1.0) const;
  /// The deepest level that is needed for points that lie so far apart; the last level where none is fine enough.
  [[nodiscard]] int level_of_spacing(double wanted) const;
  /// The deepest level that is needed for so many points.
  [[nodiscard]] int level_of_points(std::uint64_t points) const;
};

/// Nothing when the file is no COPC. Throws laz::Damage when its hierarchy contradicts itself, the header or the file;
/// takes memory for no more nodes than the file has bytes for.
[[nodiscard]] std::optional<Octree> read_octree(const ScanFile& file, const Header& header,
                                                const laz::Packing& packing);

}  // namespace sparsha::pipeline::las
