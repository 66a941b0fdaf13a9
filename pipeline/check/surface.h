// Distance from points to the bilinear surface of a depth grid: by a kd-tree that names candidate cells, and by walking
// the lattice outwards, which knows no tree and so judges it.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/check/patch.h"
#include "pipeline/check/tree.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

struct SurfaceDistance {
  double distance_m = 0;  ///< unsigned; infinite when the grid has no cell with four known nodes
  double signed_m = 0;    ///< the same, negative behind the surface
};

/// Immutable; queries are thread-safe. Points are relative to the lattice's origin, metres. The grid must outlive it.
class SurfaceIndex {
 public:
  explicit SurfaceIndex(const scene::DepthGrid& grid);

  /// Memory of one caller's queries. Blocks found for one point serve its neighbours too.
  struct Scratch {
    PointTree::Answer answer;
    std::vector<std::uint32_t> blocks;  ///< all with a tree point within `radius` of (x, y, z), spacings
    double x = 0, y = 0, z = 0, radius = -1;
  };
  /// Exact nearest distance, candidate cells from the kd-tree.
  [[nodiscard]] SurfaceDistance distance(double x_m, double y_m, double z_m, Scratch& scratch) const;
  /// The same by rings of cells about the point and by a search on their patches; gives up (infinite) when `max_rings`
  /// do not decide.
  [[nodiscard]] SurfaceDistance distance_by_walking(double x_m, double y_m, double z_m, int max_rings) const;

 private:
  /// kBlock x kBlock cells with the heights they span, relative to the lattice's origin, spacings.
  struct Block {
    int i, j;
    float low, high;
  };
  struct Best {
    double squared;
    double side;
  };
  using Closest = PatchPoint (*)(const Patch&, double, double, double) noexcept;
  void offer_cell(int i, int j, double x, double y, double z, Best& best, Closest closest = closest_on_patch) const;
  void offer_block(std::uint32_t block, double x, double y, double z, Best& best) const;
  void find_blocks(double x, double y, double z, double radius, Scratch& scratch) const;
  bool cut_into_slices(double slice, std::size_t limit);
  [[nodiscard]] SurfaceDistance result(const Best& best) const;

  const scene::DepthGrid& grid_;
  double spacing_, per_spacing_;
  double bound_ = 0;  ///< radius about a slice's centre that holds the slice, spacings
  std::vector<Block> blocks_;
  std::vector<float> slice_centres_;           ///< x y z, metres; given to the tree
  std::vector<std::uint32_t> block_of_slice_;  ///< one entry a tree point
  std::unique_ptr<PointTree> tree_;
};

}  // namespace sparsha::pipeline
