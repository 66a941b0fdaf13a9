// The lattice of a Monge depth grid z = f(x, y) and its layers in memory.
//
//  y ^   (0,ny-1) o-----o-----o      node (i,j) is at x = x0 + i*spacing, y = y0 + j*spacing
//    |            |     |     |      storage index j*nx + i: row 0 is the BOTTOM row in memory
//    |   (0,0)    o-----o-----o      (files store the top row first)
//    +---------------------> x       height inside a cell is bilinear
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace sparsha::scene {

/// What a node's height is worth. Filled is never called measured.
enum class NodeState : std::uint8_t { unknown = 0, measured = 1, filled = 2 };

inline constexpr float kUnknownHeight = std::numeric_limits<float>::quiet_NaN();

/// Regular square lattice in the grid frame. `origin_m` = (x0, y0, z0): node (0,0) and the height zero of storage.
struct Lattice {
  int nx = 0;
  int ny = 0;
  double spacing_m = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] double x_m(int i) const { return origin_m.x() + i * spacing_m; }
  [[nodiscard]] double y_m(int j) const { return origin_m.y() + j * spacing_m; }
};

/// Heights in metres relative to origin_m.z, NaN where unknown, and the mask.
struct DepthGrid {
  Lattice lattice;
  std::vector<float> height_m;
  std::vector<NodeState> state;

  DepthGrid() = default;
  explicit DepthGrid(const Lattice& l)
      : lattice(l), height_m(l.count(), kUnknownHeight), state(l.count(), NodeState::unknown) {}
};

/// A level's (or a window's) layers. Optional layers are empty when the scene has none; else one value per node.
struct Layers {
  DepthGrid grid;
  std::vector<float> envelope_m;                 ///< f_b, bilateral-filtered heights, relative to origin_m.z
  std::vector<float> curvature_per_m;            ///< k, root-mean-square principal curvature of level 0's texture
  std::vector<float> mean_curvature_per_m;       ///< H of level 0's texture (law: paper)
  std::vector<float> gaussian_curvature_per_m2;  ///< K of level 0's texture (law: paper)
  std::vector<std::uint32_t> colour_rgba;        ///< 0xAABBGGRR; 0 where no point with a colour is near
  std::vector<float> intensity;                  ///< as the scan has it, NaN where unknown
  std::uint64_t not_a_number = 0;  ///< heights that are none though the mask calls their nodes known; unknown here
};

}  // namespace sparsha::scene
