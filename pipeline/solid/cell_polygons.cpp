// Polygons of the 256 cubes are found once by walking round the faces.
#include "pipeline/solid/cell_polygons.h"

#include <cstddef>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr std::uint8_t kNoEdge = 255;

constexpr std::array<CubeEdge, 12> kEdges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

// Corners of the faces, counter-clockwise as seen from outside the cube: -x +x -y +y -z +z.
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

std::uint8_t edge_between(int a, int b) {
  for (std::uint8_t e = 0; e < kEdges.size(); ++e) {
    if ((kEdges[e].low == a && kEdges[e].high == b) || (kEdges[e].low == b && kEdges[e].high == a)) return e;
  }
  return kNoEdge;
}

std::vector<CubeLoop> loops_of(unsigned inside) {
  const auto in = [inside](int corner) { return (inside >> static_cast<unsigned>(corner) & 1U) != 0; };
  // In each face a line goes from the edge where one gets inside to the edge where one leaves.
  std::array<std::uint8_t, 12> next;
  next.fill(kNoEdge);
  for (const std::array<int, 4>& face : kFaces) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (in(face[k]) || !in(face[(k + 1) % 4])) continue;
      std::size_t last = (k + 1) % 4;
      while (in(face[(last + 1) % 4])) last = (last + 1) % 4;
      next[edge_between(face[k], face[(k + 1) % 4])] = edge_between(face[last], face[(last + 1) % 4]);
    }
  }
  std::vector<CubeLoop> loops;
  for (std::uint8_t first = 0; first < next.size(); ++first) {
    if (next[first] == kNoEdge) continue;
    CubeLoop loop;
    for (std::uint8_t at = first; next[at] != kNoEdge;) {
      loop.push_back(at);
      const std::uint8_t following = next[at];
      next[at] = kNoEdge;
      at = following;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// Shortest cuts of a loop's part from `first` to `last`, by dynamic programming.
class Cuts {
 public:
  Cuts(const CubeLoop& loop, const std::array<std::array<float, 3>, 12>& places) : loop_(loop), places_(places) {
    const std::size_t n = loop.size();
    for (std::size_t length = 2; length < n; ++length) {
      for (std::size_t first = 0; first + length < n; ++first) {
        const std::size_t last = first + length;
        float least = std::numeric_limits<float>::infinity();
        for (std::size_t k = first + 1; k < last; ++k) {
          const float here = cost(first, k) + cost(k, last);
          if (here < least) {
            least = here;
            middle_[first][last] = static_cast<std::uint8_t>(k);
          }
        }
        const bool whole = first == 0 && last == n - 1;
        cost_[first][last] = whole ? least : least + length_of(first, last);
      }
    }
  }
  [[nodiscard]] bool possible() const { return cost_[0][loop_.size() - 1] < std::numeric_limits<float>::infinity(); }
  void collect(std::size_t first, std::size_t last, LoopTriangles& triangles) const {
    if (last < first + 2) return;
    const std::uint8_t k = middle_[first][last];
    triangles.push_back({static_cast<std::uint8_t>(first), k, static_cast<std::uint8_t>(last)});
    collect(first, k, triangles);
    collect(k, last, triangles);
  }

 private:
  [[nodiscard]] float cost(std::size_t first, std::size_t last) const {
    return last == first + 1 ? 0.0F : cost_[first][last];
  }
  [[nodiscard]] float length_of(std::size_t a, std::size_t b) const {
    if (share_face(loop_[a], loop_[b])) return std::numeric_limits<float>::infinity();
    float sum = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float d = places_[loop_[a]][axis] - places_[loop_[b]][axis];
      sum += d * d;
    }
    return sum;
  }

  const CubeLoop& loop_;
  const std::array<std::array<float, 3>, 12>& places_;
  std::array<std::array<float, 12>, 12> cost_{};
  std::array<std::array<std::uint8_t, 12>, 12> middle_{};
};

}  // namespace

const std::array<CubeEdge, 12>& cube_edges() { return kEdges; }

const std::vector<CubeLoop>& cube_loops(unsigned inside) {
  static const std::array<std::vector<CubeLoop>, 256> all = [] {
    std::array<std::vector<CubeLoop>, 256> loops;
    for (unsigned mask = 0; mask < loops.size(); ++mask) loops[mask] = loops_of(mask);
    return loops;
  }();
  return all[inside & 255U];
}

bool share_face(std::uint8_t edge, std::uint8_t other) {
  const auto both =
      static_cast<unsigned>(kEdges[edge].low & kEdges[edge].high & kEdges[other].low & kEdges[other].high);
  const auto none =
      static_cast<unsigned>(kEdges[edge].low | kEdges[edge].high | kEdges[other].low | kEdges[other].high);
  return both != 0 || none != 7;
}

LoopTriangles cut_loop(const CubeLoop& loop, const std::array<std::array<float, 3>, 12>& places) {
  LoopTriangles triangles;
  const Cuts cuts(loop, places);
  if (cuts.possible()) cuts.collect(0, loop.size() - 1, triangles);
  return triangles;
}

}  // namespace sparsha::pipeline
