// Edges by sorting; crossings by a lattice of cells about as large as the triangles.
#include "tests/support/mesh_faults.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

namespace sparsha::test {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Eigen::Vector3d;

struct Edge {
  std::uint32_t low, high;
  bool upwards;
  bool operator<(const Edge& other) const { return std::pair(low, high) < std::pair(other.low, other.high); }
};

/// Six times the signed volume of a tetrahedron.
double side_of(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  return (b - a).cross(c - a).dot(p - a);
}

/// Whether the piece of line from p to q passes through the inside of a triangle.
bool pierces(const std::array<Vector3d, 3>& t, const Vector3d& p, const Vector3d& q) {
  const double at_p = side_of(t[0], t[1], t[2], p);
  const double at_q = side_of(t[0], t[1], t[2], q);
  if (!(at_p * at_q < 0.0)) return false;
  const double a = side_of(p, q, t[0], t[1]);
  const double b = side_of(p, q, t[1], t[2]);
  const double c = side_of(p, q, t[2], t[0]);
  return (a > 0.0 && b > 0.0 && c > 0.0) || (a < 0.0 && b < 0.0 && c < 0.0);
}

class Crossings {
 public:
  Crossings(const std::vector<Eigen::Vector3f>& vertices, const std::vector<Triangle>& triangles)
      : vertices_(vertices), triangles_(triangles) {
    double longest = 0.0;
    for (const Triangle& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        longest = std::max(longest, static_cast<double>((vertices[t[k]] - vertices[t[(k + 1) % 3]]).norm()));
      }
    }
    cell_ = longest;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for_cells(t, [&](std::uint64_t key) { cells_[key].push_back(t); });
    }
  }

  [[nodiscard]] std::size_t count() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const auto& [key, list] : cells_) {
      for (std::size_t a = 0; a < list.size(); ++a) {
        for (std::size_t b = a + 1; b < list.size(); ++b) {
          if (cross(list[a], list[b])) found.emplace_back(std::min(list[a], list[b]), std::max(list[a], list[b]));
        }
      }
    }
    std::sort(found.begin(), found.end());
    return static_cast<std::size_t>(std::unique(found.begin(), found.end()) - found.begin());
  }

 private:
  [[nodiscard]] std::array<Vector3d, 3> corners(std::uint32_t t) const {
    const auto at = [&](std::size_t k) { return Vector3d(vertices_[triangles_[t][k]].cast<double>()); };
    return {at(0), at(1), at(2)};
  }
  template <typename Use>
  void for_cells(std::uint32_t t, const Use& use) const {
    const std::array<Vector3d, 3> c = corners(t);
    const Eigen::Array3i low = (c[0].cwiseMin(c[1]).cwiseMin(c[2]) / cell_).array().floor().cast<int>();
    const Eigen::Array3i high = (c[0].cwiseMax(c[1]).cwiseMax(c[2]) / cell_).array().floor().cast<int>();
    for (int i = low.x(); i <= high.x(); ++i)
      for (int j = low.y(); j <= high.y(); ++j)
        for (int k = low.z(); k <= high.z(); ++k) {
          std::uint64_t key = 0;
          for (const int x : {i, j, k}) key = key << 21U | (static_cast<std::uint64_t>(x + (1 << 20)) & 0x1fffffU);
          use(key);
        }
  }
  // Triangles with one common vertex cross where the side opposite to it passes through the other; those with two
  // would have to lie on each other.
  [[nodiscard]] bool cross(std::uint32_t first, std::uint32_t second) const {
    const std::array<Vector3d, 3> a = corners(first), b = corners(second);
    int common = 0;
    for (const std::uint32_t v : triangles_[first]) {
      common += static_cast<int>(std::count(triangles_[second].begin(), triangles_[second].end(), v));
    }
    if (common > 1) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (pierces(a, b[k], b[(k + 1) % 3]) || pierces(b, a[k], a[(k + 1) % 3])) return true;
    }
    return false;
  }

  const std::vector<Eigen::Vector3f>& vertices_;
  const std::vector<Triangle>& triangles_;
  double cell_ = 1.0;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// Vertices whose triangles, from one to the next across common edges, are several fans.
std::size_t count_pinched(std::size_t vertices, const std::vector<Triangle>& triangles) {
  // At each vertex a triangle leads from one neighbour to another; in one closed fan these form one ring.
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> rings(vertices);
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) rings[t[k]].emplace_back(t[(k + 1) % 3], t[(k + 2) % 3]);
  }
  std::size_t pinched = 0;
  for (const auto& ring : rings) {
    if (ring.empty()) continue;
    std::size_t steps = 0;
    std::uint32_t at = ring.front().first;
    do {
      const auto found = std::find_if(ring.begin(), ring.end(), [at](const auto& r) { return r.first == at; });
      if (found == ring.end()) break;
      at = found->second;
      ++steps;
    } while (at != ring.front().first && steps <= ring.size());
    pinched += steps != ring.size() ? 1 : 0;
  }
  return pinched;
}

}  // namespace

MeshFaults find_mesh_faults(const std::vector<Eigen::Vector3f>& vertices, const std::vector<Triangle>& triangles) {
  MeshFaults faults;
  std::vector<Edge> edges;
  std::vector<bool> used(vertices.size(), false);
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
      used[a] = true;
    }
    const Eigen::Vector3f& a = vertices[t[0]];
    faults.flat += (vertices[t[1]] - a).cross(vertices[t[2]] - a).norm() > 0.0F ? 0 : 1;
  }
  std::sort(edges.begin(), edges.end());
  long distinct = 0;
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k;
    int upwards = 0;
    while (end < edges.size() && edges[end].low == edges[k].low && edges[end].high == edges[k].high) {
      upwards += edges[end].upwards ? 1 : 0;
      ++end;
    }
    if (end - k == 1) {
      ++faults.open_edges;
    } else if (end - k != 2 || upwards != 1) {
      ++faults.bad_edges;
    }
    ++distinct;
    k = end;
  }
  faults.euler = std::count(used.begin(), used.end(), true) - distinct + static_cast<long>(triangles.size());
  faults.pinched = count_pinched(vertices.size(), triangles);
  faults.crossings = Crossings(vertices, triangles).count();
  return faults;
}

}  // namespace sparsha::test
