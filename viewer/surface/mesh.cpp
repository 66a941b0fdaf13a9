// A quadtree of cells. A whole cell beside a divided one takes over the nodes of their common side: no cracks.
#include "viewer/surface/mesh.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace sparsha::viewer {
namespace {

constexpr int kChunk = 16;  // cells of the mesh's level along a chunk's side
constexpr int kMostLevels = 7;

}  // namespace

CellTree::CellTree(const Joints& joints) {
  levels_.push_back({std::max(joints.nx - 1, 0), std::max(joints.ny - 1, 0), joints.cell});
  while (static_cast<int>(levels_.size()) < kMostLevels && std::max(levels_.back().nx, levels_.back().ny) > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.nx + 1) / 2, (fine.ny + 1) / 2, {}};
    coarse.kind.reserve(static_cast<std::size_t>(coarse.nx) * static_cast<std::size_t>(coarse.ny));
    for (int j = 0; j < coarse.ny; ++j)
      for (int i = 0; i < coarse.nx; ++i) {
        CellKind all = CellKind::mixed;
        bool first = true;
        for (int b = 2 * j; b < std::min(2 * j + 2, fine.ny); ++b)
          for (int a = 2 * i; a < std::min(2 * i + 2, fine.nx); ++a) {
            const CellKind one = fine.kind[static_cast<std::size_t>(b) * static_cast<std::size_t>(fine.nx) +
                                           static_cast<std::size_t>(a)];
            all = first || one == all ? one : CellKind::mixed;
            first = false;
          }
        coarse.kind.push_back(all);
      }
    levels_.push_back(std::move(coarse));
  }
}

CellKind CellTree::kind(int level, int i, int j) const {
  const Level& at = levels_[static_cast<std::size_t>(level)];
  if (i < 0 || j < 0 || i >= at.nx || j >= at.ny) return CellKind::empty;
  return at.kind[static_cast<std::size_t>(j) * static_cast<std::size_t>(at.nx) + static_cast<std::size_t>(i)];
}

class CellTree::Builder {
 public:
  Builder(const CellTree& tree, const Joints& joints, const std::vector<float>& height_m, Mesh& mesh)
      : tree_(tree), joints_(joints), height_m_(height_m), mesh_(mesh) {}

  void add(int level, int i, int j) {
    const CellKind kind = tree_.kind(level, i, j);
    if (kind == CellKind::empty) return;
    if (kind == CellKind::whole) return add_whole(level, i, j);
    if (level == 0) return add_mixed(i, j);
    for (int b = 0; b < 2; ++b)
      for (int a = 0; a < 2; ++a) add(level - 1, 2 * i + a, 2 * j + b);
  }

 private:
  [[nodiscard]] std::uint32_t node(int i, int j) const {
    return static_cast<std::uint32_t>(joints_.index(std::min(i, joints_.nx - 1), std::min(j, joints_.ny - 1)));
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  }

  /// Nodes strictly between the ends of one side of a whole cell that the neighbour beyond it uses. `side` 0 lower,
  /// 1 right, 2 upper, 3 left; in the order of increasing i or j.
  void side_nodes(int level, int i, int j, int side) {
    // The neighbour's cell in the coordinates of its level.
    if (tree_.kind(level, i, j) != CellKind::mixed || level == 0) return;
    const bool along_x = side == 0 || side == 2;
    // Children of the neighbour that touch the side: the neighbour below touches with its upper row.
    const int a0 = 2 * i + (side == 3 ? 1 : 0), b0 = 2 * j + (side == 0 ? 1 : 0);
    const int half = 1 << (level - 1);
    const int first_i = along_x ? 2 * i : a0, first_j = along_x ? b0 : 2 * j;
    side_nodes(level - 1, first_i, first_j, side);
    const int at = (along_x ? first_i + 1 : first_j + 1) * half;
    const int end = along_x ? joints_.nx - 1 : joints_.ny - 1;
    if (at >= end) return;
    side_.push_back(at);
    side_nodes(level - 1, along_x ? first_i + 1 : first_i, along_x ? first_j : first_j + 1, side);
  }

  void add_whole(int level, int i, int j) {
    const int size = 1 << level;
    const int i0 = i * size, j0 = j * size;
    const int i1 = std::min(i0 + size, joints_.nx - 1), j1 = std::min(j0 + size, joints_.ny - 1);
    const std::uint32_t a = node(i0, j0), b = node(i1, j0), c = node(i1, j1), d = node(i0, j1);
    if (level == 0 ||
        (tree_.kind(level, i, j - 1) != CellKind::mixed && tree_.kind(level, i + 1, j) != CellKind::mixed &&
         tree_.kind(level, i, j + 1) != CellKind::mixed && tree_.kind(level, i - 1, j) != CellKind::mixed)) {
      triangle(a, b, c);
      triangle(a, c, d);
      return;
    }
    // Counterclockwise around the cell.
    ring_.clear();
    const auto take = [&](std::uint32_t corner, int ni, int nj, int side) {
      ring_.push_back(corner);
      side_.clear();
      side_nodes(level, ni, nj, side);
      if (side >= 2) std::ranges::reverse(side_);
      for (const int at : side_)
        ring_.push_back(side == 0 ? node(at, j0) : side == 1 ? node(i1, at) : side == 2 ? node(at, j1) : node(i0, at));
    };
    take(a, i, j - 1, 0);
    take(b, i + 1, j, 1);
    take(c, i, j + 1, 2);
    take(d, i - 1, j, 3);
    const int mi = (i0 + i1) / 2, mj = (j0 + j1) / 2;
    if (mi > i0 && mj > j0) {
      const std::uint32_t middle = node(mi, mj);
      for (std::size_t k = 0; k < ring_.size(); ++k) triangle(middle, ring_[k], ring_[(k + 1) % ring_.size()]);
    } else {
      for (std::size_t k = 1; k + 1 < ring_.size(); ++k) triangle(ring_[0], ring_[k], ring_[k + 1]);
    }
  }

  /// Across a step the cell belongs to the ground behind, which goes on under the near form's rim.
  void add_mixed(int i, int j) {
    std::array<std::uint32_t, 4> corner{node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)};
    float low = height_m_[corner[0]], high = low;
    for (const std::uint32_t c : corner) {
      low = std::min(low, height_m_[c]);
      high = std::max(high, height_m_[c]);
    }
    const float middle = 0.5F * (low + high);
    const auto count = static_cast<std::uint32_t>(height_m_.size());
    float least = std::numeric_limits<float>::infinity(), most = -least;
    for (std::uint32_t& c : corner) {
      const bool far = height_m_[c] > middle && joints_.far_m[c] < middle;
      const float z = far ? joints_.far_m[c] : height_m_[c];
      least = std::min(least, z);
      most = std::max(most, z);
      if (far) c += count;
    }
    if (most - least > joints_.cliff_m) return;  // it would hang between two forms all the same
    triangle(corner[0], corner[1], corner[2]);
    triangle(corner[0], corner[2], corner[3]);
  }

  const CellTree& tree_;
  const Joints& joints_;
  const std::vector<float>& height_m_;
  Mesh& mesh_;
  std::vector<int> side_;
  std::vector<std::uint32_t> ring_;
};

Mesh CellTree::mesh(int level, const Joints& joints, const std::vector<float>& height_m) const {
  Mesh mesh;
  level = std::clamp(level, 0, levels() - 1);
  Builder builder(*this, joints, height_m, mesh);
  const Level& at = levels_[static_cast<std::size_t>(level)];
  const int size = 1 << level;
  for (int cj = 0; cj < at.ny; cj += kChunk)
    for (int ci = 0; ci < at.nx; ci += kChunk) {
      Mesh::Chunk chunk;
      const int ei = std::min(ci + kChunk, at.nx), ej = std::min(cj + kChunk, at.ny);
      chunk.nodes = {ci * size, cj * size, std::min(ei * size, joints.nx - 1), std::min(ej * size, joints.ny - 1)};
      chunk.first = static_cast<std::uint32_t>(mesh.indices.size());
      for (int j = cj; j < ej; ++j)
        for (int i = ci; i < ei; ++i) builder.add(level, i, j);
      chunk.count = static_cast<std::uint32_t>(mesh.indices.size()) - chunk.first;
      if (chunk.count > 0) mesh.chunks.push_back(chunk);
    }
  return mesh;
}

}  // namespace sparsha::viewer
