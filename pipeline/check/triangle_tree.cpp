// Built from the root down to some hundred parts by one thread, and the parts by all; searched with the nearer child
// first. Nearest point of a triangle: Ericson 2005, "Real-Time Collision Detection", 5.1.5.
#include "pipeline/check/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr std::uint32_t kLeaf = 4;  // triangles
constexpr std::uint32_t kParts = 256;
constexpr std::size_t kDeepest = 64;  // halvings of 2^32 triangles, and to spare
constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Vector = Eigen::Vector3d;

Vector closest_on_segment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = b - a;
  const double length2 = ab.squaredNorm();
  return length2 > 0.0 ? Vector(a + std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) * ab) : a;
}

Vector closest_on_edges(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  Vector best = closest_on_segment(p, a, b);
  for (const Vector& q : {closest_on_segment(p, b, c), closest_on_segment(p, c, a)}) {
    if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
  }
  return best;
}

Vector closest_on_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a;
  const Vector ac = c - a;
  const Vector normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  const Vector ap = p - a;
  // Barycentric coordinates of the point's projection; where one is negative the nearest point lies on an edge.
  const double v = ap.cross(ac).dot(normal);
  const double w = ab.cross(ap).dot(normal);
  constexpr double kSliver = 1e-20;  // squared sine of the corner: its edges are the triangle
  if (!(area2 > kSliver * ab.squaredNorm() * ac.squaredNorm()) || v < 0.0 || w < 0.0 || v + w > area2)
    return closest_on_edges(p, a, b, c);
  return a + (v / area2) * ab + (w / area2) * ac;
}

}  // namespace

/// Sorts the faces' numbers into leaves.
class TriangleTree::Builder {
 public:
  Builder(const std::vector<float>& xyz, const std::vector<std::array<std::uint32_t, 3>>& faces, ThreadPool& pool)
      : xyz_(xyz), faces_(faces), pool_(pool), order_(faces.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
  }

  std::vector<Node> build() {
    const auto all = static_cast<std::uint32_t>(order_.size());
    std::vector<Node> nodes(1);
    if (all == 0) return {};
    std::vector<Open> parts;
    split(nodes, {0, 0, all}, std::max(kLeaf, all / kParts), &parts);
    std::vector<std::vector<Node>> trees(parts.size());
    pool_.for_ranges(parts.size(), 1, [&](std::size_t part, std::size_t) {
      trees[part].resize(1);
      split(trees[part], {0, parts[part].begin, parts[part].end}, kLeaf, nullptr);
    });
    for (std::size_t part = 0; part < parts.size(); ++part) {
      // The root takes its place, the others follow behind what is there.
      const auto shift = static_cast<std::uint32_t>(nodes.size()) - 1;
      for (Node& node : trees[part]) {
        if (node.count == 0) node.first += shift;
      }
      nodes[parts[part].node] = trees[part].front();
      nodes.insert(nodes.end(), trees[part].begin() + 1, trees[part].end());
    }
    return nodes;
  }
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  struct Open {
    std::uint32_t node, begin, end;
  };

  [[nodiscard]] Box box_of(std::uint32_t face) const {
    Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (const std::uint32_t v : faces_[face]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], xyz_[3 * std::size_t{v} + axis]);
        box.high[axis] = std::max(box.high[axis], xyz_[3 * std::size_t{v} + axis]);
      }
    }
    return box;
  }

  [[nodiscard]] float centre(std::uint32_t face, std::size_t axis) const {
    const auto& [a, b, c] = faces_[face];
    return xyz_[3 * std::size_t{a} + axis] + xyz_[3 * std::size_t{b} + axis] + xyz_[3 * std::size_t{c} + axis];
  }

  /// Splits down to `least` triangles; what is left goes to `parts`, or is a leaf.
  void split(std::vector<Node>& nodes, const Open& root, std::uint32_t least, std::vector<Open>* parts) {
    std::vector<Open> open{root};
    while (!open.empty()) {
      const Open here = open.back();
      open.pop_back();
      if (here.end - here.begin <= least && parts != nullptr) {
        parts->push_back(here);
        continue;
      }
      Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
      Box centres = box;
      for (std::uint32_t k = here.begin; k < here.end; ++k) {
        const Box face = box_of(order_[k]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          box.low[axis] = std::min(box.low[axis], face.low[axis]);
          box.high[axis] = std::max(box.high[axis], face.high[axis]);
          const float c = centre(order_[k], axis);
          centres.low[axis] = std::min(centres.low[axis], c);
          centres.high[axis] = std::max(centres.high[axis], c);
        }
      }
      nodes[here.node].box = box;
      if (here.end - here.begin <= least) {
        nodes[here.node].first = here.begin;
        nodes[here.node].count = here.end - here.begin;
        continue;
      }
      std::size_t longest = 0;
      for (std::size_t axis = 1; axis < 3; ++axis) {
        if (centres.high[axis] - centres.low[axis] > centres.high[longest] - centres.low[longest]) longest = axis;
      }
      const std::uint32_t middle = here.begin + (here.end - here.begin) / 2;
      std::nth_element(order_.begin() + here.begin, order_.begin() + middle, order_.begin() + here.end,
                       [&](std::uint32_t a, std::uint32_t b) {
                         const float at_a = centre(a, longest);
                         const float at_b = centre(b, longest);
                         return at_a != at_b ? at_a < at_b : a < b;
                       });
      const auto children = static_cast<std::uint32_t>(nodes.size());
      nodes[here.node].first = children;
      nodes.resize(nodes.size() + 2);
      open.push_back({children, here.begin, middle});
      open.push_back({children + 1, middle, here.end});
    }
  }

  const std::vector<float>& xyz_;
  const std::vector<std::array<std::uint32_t, 3>>& faces_;
  ThreadPool& pool_;
  std::vector<std::uint32_t> order_;
};

TriangleTree::TriangleTree(std::vector<float> xyz, const std::vector<std::array<std::uint32_t, 3>>& faces,
                           ThreadPool& pool)
    : xyz_(std::move(xyz)) {
  Builder builder(xyz_, faces, pool);
  nodes_ = builder.build();
  faces_.reserve(faces.size());
  for (const std::uint32_t face : builder.order()) faces_.push_back(faces[face]);
}

TriangleTree::Triangle TriangleTree::triangle(std::uint32_t number) const {
  Triangle corners{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float* const p = xyz_.data() + 3 * std::size_t{faces_[number][k]};
    corners[k] = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  return corners;
}

double TriangleTree::signed_distance(double x, double y, double z) const {
  const Vector p(x, y, z);
  const auto away2 = [&](const Box& box) {
    double sum = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = p[static_cast<Eigen::Index>(axis)];
      const double d =
          std::max({static_cast<double>(box.low[axis]) - at, at - static_cast<double>(box.high[axis]), 0.0});
      sum += d * d;
    }
    return sum;
  };
  double best2 = std::numeric_limits<double>::infinity();
  double side = 1.0;
  struct Waiting {
    std::uint32_t node;
    double away2;
  };
  std::array<Waiting, kDeepest> stack{};
  std::size_t height = 0;
  if (!nodes_.empty()) stack[height++] = {0, away2(nodes_[0].box)};
  while (height > 0) {
    const Waiting here = stack[--height];
    if (here.away2 > best2) continue;
    const Node& node = nodes_[here.node];
    if (node.count == 0) {
      Waiting near{node.first, away2(nodes_[node.first].box)};
      Waiting far{node.first + 1, away2(nodes_[node.first + 1].box)};
      if (far.away2 < near.away2) std::swap(near, far);
      if (far.away2 <= best2) stack[height++] = far;
      if (near.away2 <= best2) stack[height++] = near;
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Triangle t = triangle(k);
      const Vector q = closest_on_triangle(p, Vector(t[0].data()), Vector(t[1].data()), Vector(t[2].data()));
      const double found2 = (q - p).squaredNorm();
      // Of points at equal distances the one nearer to the viewer counts.
      const double above = q.z() < z ? -1.0 : 1.0;
      if (found2 < best2 || (found2 == best2 && above > side)) {
        best2 = found2;
        side = above;
      }
    }
  }
  return side * std::sqrt(best2);
}

std::optional<double> TriangleTree::highest(double x, double y) const {
  std::optional<double> best;
  const auto may_be_higher = [&](const Box& box) {
    return x >= static_cast<double>(box.low[0]) && x <= static_cast<double>(box.high[0]) &&
           y >= static_cast<double>(box.low[1]) && y <= static_cast<double>(box.high[1]) &&
           (!best || static_cast<double>(box.high[2]) > *best);
  };
  std::array<std::uint32_t, kDeepest> stack{};
  std::size_t height = 0;
  if (!nodes_.empty()) stack[height++] = 0;
  while (height > 0) {
    const Node& node = nodes_[stack[--height]];
    if (!may_be_higher(node.box)) continue;
    if (node.count == 0) {
      const bool second_higher = nodes_[node.first + 1].box.high[2] > nodes_[node.first].box.high[2];
      stack[height++] = node.first + (second_higher ? 0 : 1);
      stack[height++] = node.first + (second_higher ? 1 : 0);
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Triangle t = triangle(k);
      const auto turn = [&](std::size_t a, std::size_t b) {
        return (t[b][0] - t[a][0]) * (y - t[a][1]) - (t[b][1] - t[a][1]) * (x - t[a][0]);
      };
      const std::array<double, 3> w{turn(1, 2), turn(2, 0), turn(0, 1)};
      const double area = w[0] + w[1] + w[2];
      const bool inside = area > 0.0 ? std::min({w[0], w[1], w[2]}) >= 0.0 : std::max({w[0], w[1], w[2]}) <= 0.0;
      if (area == 0.0 || !inside) continue;
      const double z = (w[0] * t[0][2] + w[1] * t[1][2] + w[2] * t[2][2]) / area;
      if (!best || z > *best) best = z;
    }
  }
  return best;
}

}  // namespace sparsha::pipeline
