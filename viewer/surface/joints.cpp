// Depth steps along rows and columns, the ground behind them, and the cells that they cut.
#include "viewer/surface/joints.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sparsha::viewer {
namespace {

constexpr float kSteepest = 5.0F;  // rise per spacing that a surface seen from straight above still shows
constexpr float kCliff = 12.0F;    // rise per spacing that no scan from the front has seen as a surface
constexpr int kLongestStep = 2;    // cells

/// Marks the steps of one row or column of `count` nodes that lie `stride` apart.
void mark_line(const float* height, const std::uint8_t* known, std::uint8_t* step, int count, std::size_t stride,
               float steep_m, std::uint8_t bit) {
  const float cliff_m = steep_m * kCliff / kSteepest;
  const auto steep = [&](int k) {
    const std::size_t a = static_cast<std::size_t>(k) * stride, b = a + stride;
    return known[a] != 0 && known[b] != 0 && std::abs(height[b] - height[a]) > steep_m;
  };
  for (int k = 0; k + 1 < count;) {
    int end = k;
    while (end + 1 < count && steep(end)) ++end;
    if (end == k) {
      ++k;
      continue;
    }
    for (int m = k; m < end; ++m) {
      const std::size_t a = static_cast<std::size_t>(m) * stride;
      const bool cliff = std::abs(height[a + stride] - height[a]) > cliff_m;
      if (cliff || end - k <= kLongestStep) step[a] |= bit;
    }
    k = end;
  }
}

/// Calls `look(neighbour)` for the up to eight neighbours of node (i, j).
template <typename Look>
void for_neighbours(const Joints& joints, int i, int j, Look look) {
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, joints.ny - 1); ++b)
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, joints.nx - 1); ++a)
      if (a != i || b != j) look(joints.index(a, b));
}

/// Unknown nodes beside known ones take their mean, so that the rim's cells go on level.
void level_the_rim(std::vector<float>& height_m, const std::vector<std::uint8_t>& known, const Joints& joints) {
  for (int j = 0; j < joints.ny; ++j)
    for (int i = 0; i < joints.nx; ++i) {
      const std::size_t node = joints.index(i, j);
      if (known[node] != 0) continue;
      float sum = 0.0F;
      int count = 0;
      for_neighbours(joints, i, j, [&](std::size_t other) {
        if (known[other] == 0) return;
        sum += height_m[other];
        ++count;
      });
      if (count > 0) height_m[node] = sum / static_cast<float>(count);
    }
}

void find_ground(const std::vector<float>& height_m, const std::vector<std::uint8_t>& known, float steep_m,
                 Joints& joints) {
  joints.far_m = height_m;
  for (int j = 0; j < joints.ny; ++j)
    for (int i = 0; i < joints.nx; ++i) {
      const std::size_t node = joints.index(i, j);
      float lowest = height_m[node];
      for_neighbours(joints, i, j, [&](std::size_t other) {
        if (known[other] != 0) lowest = std::min(lowest, height_m[other]);
      });
      if (lowest < height_m[node] - steep_m) joints.far_m[node] = lowest;
    }
}

void sort_cells(const std::vector<std::uint8_t>& known, Joints& joints) {
  const int cx = std::max(joints.nx - 1, 0), cy = std::max(joints.ny - 1, 0);
  joints.cell.assign(static_cast<std::size_t>(cx) * static_cast<std::size_t>(cy), CellKind::empty);
  for (int j = 0; j < cy; ++j)
    for (int i = 0; i < cx; ++i) {
      const std::size_t a = joints.index(i, j), b = joints.index(i, j + 1);
      const int corners = (known[a] != 0) + (known[a + 1] != 0) + (known[b] != 0) + (known[b + 1] != 0);
      const auto has = [&](std::size_t node, std::uint8_t bit) { return (joints.step[node] & bit) != 0 ? 1 : 0; };
      const int steps =
          has(a, Joints::kStepX) + has(a, Joints::kStepY) + has(a + 1, Joints::kStepY) + has(b, Joints::kStepX);
      // Loose points at a grazing angle are no surface.
      const bool loose = steps == 4 || (steps > 0 && corners < 4);
      joints.cell[static_cast<std::size_t>(j) * static_cast<std::size_t>(cx) + static_cast<std::size_t>(i)] =
          corners == 0 || loose      ? CellKind::empty
          : corners < 4 || steps > 0 ? CellKind::mixed
                                     : CellKind::whole;
    }
}

}  // namespace

Joints find_joints(std::vector<float>& height_m, const std::vector<std::uint8_t>& known, int nx, int ny,
                   double spacing_m) {
  Joints joints;
  joints.nx = nx;
  joints.ny = ny;
  joints.step.assign(height_m.size(), 0);
  const float steep_m = kSteepest * static_cast<float>(spacing_m);
  joints.cliff_m = kCliff * static_cast<float>(spacing_m);
  for (int j = 0; j < ny; ++j) {
    const std::size_t row = joints.index(0, j);
    mark_line(height_m.data() + row, known.data() + row, joints.step.data() + row, nx, 1, steep_m, Joints::kStepX);
  }
  for (int i = 0; i < nx; ++i) {
    const auto column = static_cast<std::size_t>(i);
    mark_line(height_m.data() + column, known.data() + column, joints.step.data() + column, ny,
              static_cast<std::size_t>(nx), steep_m, Joints::kStepY);
  }
  level_the_rim(height_m, known, joints);
  find_ground(height_m, known, steep_m, joints);
  sort_cells(known, joints);
  return joints;
}

}  // namespace sparsha::viewer
