// Which cells of a whole object's sheets are drawn: one sheet at a place but for a narrow overlap, and on to where two
// sheets meet at a sharp edge. Lengths in spacings of the charts; chart frame of each sheet's side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "scene/charts.h"

namespace sparsha::viewer {

/// One sheet, with room for a continuation around it. Storage index j * nx + i.
struct DrawnSheet {
  enum class Node : std::uint8_t {
    none,
    measured,
    continued,  ///< beyond the border, along the slopes there
    met,        ///< the same, where the way from the sheet came to another sheet, on which it is drawn
    closed      ///< in a small hole of the sheet
  };
  scene::SideAxes axes{0, 1, 2, 1.0};
  scene::Side side = scene::Side::front;
  int first_u = 0, first_v = 0;  ///< node (0, 0)
  int nx = 0, ny = 0;
  std::vector<Node> node;
  std::vector<float> height;               ///< of measured nodes and of all that a continuation reaches; else NaN
  std::vector<float> slope_u, slope_v;     ///< likewise
  std::vector<float> texture_m;            ///< likewise; empty where the charts have none, as the next
  std::vector<float> bend_per_m;           ///< curvature of the texture; NaN also where nothing tells it
  std::vector<std::uint32_t> colour_rgba;  ///< likewise; 0 where there is none
  std::vector<float> intensity;            ///< likewise
  std::vector<float> error_m;              ///< likewise
  std::vector<std::uint8_t> cell;          ///< 1: measured; 2: measured and drawn; 3: continued and drawn
  std::vector<Eigen::Vector3f> moved;      ///< object frame: places of `met` nodes, in the order of their index

  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  /// Outward unit normal, object frame. Requires a height.
  [[nodiscard]] Eigen::Vector3d normal(std::size_t k) const {
    const Eigen::Vector3d n(-static_cast<double>(slope_u[k]), -static_cast<double>(slope_v[k]), 1.0);
    return axes.to_grid(Eigen::Vector3d(n.normalized()));
  }
  /// Object frame, of the lattice's own place. Requires a height.
  [[nodiscard]] Eigen::Vector3d place(int i, int j) const {
    return axes.to_grid(Eigen::Vector3d(first_u + i, first_v + j, static_cast<double>(height[index(i, j)])));
  }
};

/// The drawn cells cover what the sheets measured: a cell is left out only where one other sheet that faces the surface
/// better, by a margin, has it whole. Independent of the number of threads. Cost: about 0.3 us per node.
[[nodiscard]] std::vector<DrawnSheet> drawn_sheets(const scene::Charts& charts, ThreadPool& pool);

}  // namespace sparsha::viewer
