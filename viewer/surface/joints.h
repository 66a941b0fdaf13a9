// Which cells of a lattice are drawn: none that would join a near form to a far one behind it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sparsha::viewer {

/// How a cell between four nodes is drawn.
enum class CellKind : std::uint8_t {
  empty,  ///< no corner is known
  whole,  ///< four known corners on one surface
  mixed   ///< at the rim of what is known, or across a depth step
};

/// What joins neighbouring nodes. Vectors hold nx * ny nodes, storage index j * nx + i.
struct Joints {
  static constexpr std::uint8_t kStepX = 1, kStepY = 2;  ///< bits of `step`
  int nx = 0;
  int ny = 0;
  float cliff_m = 0.0F;            ///< most that the corners of a drawn cell may differ in height at a rim or step
  std::vector<CellKind> cell;      ///< (nx - 1) * (ny - 1), index j * (nx - 1) + i
  std::vector<std::uint8_t> step;  ///< of a node: depth steps to node i + 1 and to node j + 1
  std::vector<float> far_m;        ///< height of the ground behind a step beside the node; else the node's own

  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
};

/// Two measured neighbours belong to one surface unless they lie on both sides of a depth step: a run of at most two
/// cells, each steeper than 79 degrees, or any cell steeper than 85. Longer runs between are steep stone. `height_m`
/// where `known` is not 0; elsewhere a continuation of any kind, which is replaced at the rim by the mean of the known
/// neighbours.
[[nodiscard]] Joints find_joints(std::vector<float>& height_m, const std::vector<std::uint8_t>& known, int nx, int ny,
                                 double spacing_m);

}  // namespace sparsha::viewer
