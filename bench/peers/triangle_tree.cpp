#include "bench/peers/triangle_tree.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeaf = 4;
constexpr int kDeepest = 64;
constexpr double kOverlap = 1e-6;  // of a triangle: neighbours overlap, so that no ray slips between them
constexpr double kBelow = 4e-6;    // of the spacing

}  // namespace

Vector3d closest_point(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto on_edge = [&p](const Vector3d& from, const Vector3d& to) -> Vector3d {
    const Vector3d way = to - from;
    return from + std::clamp((p - from).dot(way) / way.squaredNorm(), 0.0, 1.0) * way;
  };
  const Vector3d normal = (b - a).cross(c - a);
  const double inside_ab = normal.dot((b - a).cross(p - a));
  const double inside_bc = normal.dot((c - b).cross(p - b));
  const double inside_ca = normal.dot((a - c).cross(p - c));
  if (inside_ab >= 0.0 && inside_bc >= 0.0 && inside_ca >= 0.0)
    return p - normal * (normal.dot(p - a) / normal.squaredNorm());
  Vector3d best = on_edge(a, b);
  for (const Vector3d& other : {on_edge(b, c), on_edge(c, a)})
    if ((other - p).squaredNorm() < (best - p).squaredNorm()) best = other;
  return best;
}

TriangleTree::TriangleTree(const haptics::MongeSurface& surface) : spacing_m_(surface.lattice.spacing_m) {
  const int nx = surface.lattice.nx;
  const int ny = surface.lattice.ny;
  vertices_.reserve(surface.lattice.count());
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      vertices_.push_back(
          Vector3d(i * spacing_m_, j * spacing_m_, surface.height_m[surface.lattice.index(i, j)]).cast<float>());
  triangles_.reserve(2 * surface.lattice.count());
  for (int j = 0; j + 1 < ny; ++j)
    for (int i = 0; i + 1 < nx; ++i) {
      const int node = j * nx + i;
      triangles_.push_back({{node, node + 1, node + nx}});
      triangles_.push_back({{node + 1, node + nx + 1, node + nx}});
    }
  boxes_.reserve(triangles_.size());
  split(0, triangles_.size());
  boxes_.shrink_to_fit();
}

void TriangleTree::split(std::size_t begin, std::size_t end) {
  const std::size_t here = boxes_.size();
  boxes_.emplace_back();
  Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::max());
  Eigen::Array3f high = -low;
  for (std::size_t k = begin; k < end; ++k)
    for (const std::int32_t node : triangles_[k].node) {
      low = low.min(vertices_[static_cast<std::size_t>(node)].array());
      high = high.max(vertices_[static_cast<std::size_t>(node)].array());
    }
  const auto margin = static_cast<float>(1e-5 * spacing_m_);
  for (int axis = 0; axis < 3; ++axis) {
    boxes_[here].low[axis] = low[axis] - margin;
    boxes_[here].high[axis] = high[axis] + margin;
  }
  if (end - begin <= kLeaf) {
    boxes_[here].first = static_cast<std::int32_t>(begin);
    boxes_[here].count = static_cast<std::int32_t>(end - begin);
    return;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto at = [this, axis](const Triangle& t) {
    float sum = 0.0F;
    for (const std::int32_t node : t.node) sum += vertices_[static_cast<std::size_t>(node)][axis];
    return sum;
  };
  const std::size_t middle = begin + (end - begin) / 2;
  const auto first = triangles_.begin();
  std::nth_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(middle),
                   first + static_cast<std::ptrdiff_t>(end),
                   [&at](const Triangle& a, const Triangle& b) { return at(a) < at(b); });
  split(begin, middle);
  boxes_[here].first = static_cast<std::int32_t>(boxes_.size());
  split(middle, end);
}

void TriangleTree::meet(std::int32_t index, const Vector3d& from, const Vector3d& way, Hit& best) const {
  const Triangle& triangle = triangles_[static_cast<std::size_t>(index)];
  // Moller & Trumbore 1997.
  const Vector3d a = vertex(triangle, 0);
  const Vector3d ab = vertex(triangle, 1) - a;
  const Vector3d ac = vertex(triangle, 2) - a;
  const Vector3d normal = ab.cross(ac);
  const double falls = -way.dot(normal);
  if (!(falls > 0.0)) return;
  const Vector3d out = from - a;
  double share = out.dot(normal) / falls;
  // Where the proxy was lifted off one side of a narrow groove it may be a rounding below the other.
  if (share < 0.0 && out.dot(normal) > -kBelow * spacing_m_ * normal.norm()) share = 0.0;
  if (!(share >= 0.0) || share >= best.share || share > 1.0) return;
  const Vector3d side = out.cross(way);
  const double v = ac.dot(side) / falls;
  const double w = -ab.dot(side) / falls;
  if (std::min(v, w) < -kOverlap || v + w > 1.0 + kOverlap) return;
  best.share = share;
  best.normal = normal;
  best.triangle = index;
}

bool TriangleTree::is_over(std::int32_t triangle, const Vector3d& point, double height_m) const {
  const Triangle& t = triangles_[static_cast<std::size_t>(triangle)];
  const Vector3d a = vertex(t, 0);
  const Vector3d ab = vertex(t, 1) - a;
  const Vector3d ac = vertex(t, 2) - a;
  const Vector3d normal = ab.cross(ac);
  const Vector3d out = point - a;
  const double squared = normal.squaredNorm();
  const double height = out.dot(normal);
  if (height < 0.0 || height * height > height_m * height_m * squared) return false;
  const double v = out.cross(ac).dot(normal) / squared;
  const double w = ab.cross(out).dot(normal) / squared;
  return std::min(v, w) > 0.0 && v + w < 1.0;
}

TriangleTree::Hit TriangleTree::first_hit(const Vector3d& from, const Vector3d& to) const {
  Hit best;
  const Vector3d way = to - from;
  const Eigen::Array3d inverse = way.array().inverse();
  const auto enters = [&](const Box& box) {  // share of the way; above 1: never
    double in = 0.0;
    double out = std::min(1.0, best.share);
    for (int axis = 0; axis < 3; ++axis) {
      if (way[axis] == 0.0) {
        if (from[axis] < box.low[axis] || from[axis] > box.high[axis]) return 2.0;
        continue;
      }
      const double one = (box.low[axis] - from[axis]) * inverse[axis];
      const double two = (box.high[axis] - from[axis]) * inverse[axis];
      in = std::max(in, std::min(one, two));
      out = std::min(out, std::max(one, two));
    }
    return in <= out ? in : 2.0;
  };
  std::int32_t stack[kDeepest];
  int depth = 0;
  if (enters(boxes_[0]) <= 1.0) stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t here = stack[--depth];
    const Box& box = boxes_[static_cast<std::size_t>(here)];
    for (std::int32_t k = 0; k < box.count; ++k) meet(box.first + k, from, way, best);
    if (box.count > 0) continue;
    const std::int32_t one = here + 1;
    const std::int32_t two = box.first;
    const double in_one = enters(boxes_[static_cast<std::size_t>(one)]);
    const double in_two = enters(boxes_[static_cast<std::size_t>(two)]);
    // The nearer last, so that it is looked at first.
    if (std::max(in_one, in_two) <= 1.0) stack[depth++] = in_one > in_two ? one : two;
    if (std::min(in_one, in_two) <= 1.0) stack[depth++] = in_one > in_two ? two : one;
  }
  if (best.share <= 1.0) best.normal.normalize();
  return best;
}

double TriangleTree::squared_distance(const Box& box, const Vector3d& point) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = std::max({0.0, box.low[axis] - point[axis], point[axis] - box.high[axis]});
    sum += d * d;
  }
  return sum;
}

void TriangleTree::near(const Vector3d& point, double reach, std::vector<Near>& found) const {
  found.clear();
  std::int32_t stack[kDeepest];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t here = stack[--depth];
    const Box& box = boxes_[static_cast<std::size_t>(here)];
    if (squared_distance(box, point) > reach * reach) continue;
    for (std::int32_t k = 0; k < box.count; ++k) {
      const Triangle& t = triangles_[static_cast<std::size_t>(box.first + k)];
      const Vector3d a = vertex(t, 0), b = vertex(t, 1), c = vertex(t, 2);
      const Vector3d closest = closest_point(point, a, b, c);
      if ((closest - point).squaredNorm() <= reach * reach)
        found.push_back({closest, (b - a).cross(c - a).normalized()});
    }
    if (box.count > 0) continue;
    stack[depth++] = box.first;
    stack[depth++] = here + 1;
  }
}

std::optional<Vector3d> TriangleTree::nearest(const Vector3d& point, double bound) const {
  double best = bound * bound;
  std::optional<Vector3d> found;
  const auto away = [&point](const Box& box) { return squared_distance(box, point); };
  std::int32_t stack[kDeepest];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t here = stack[--depth];
    const Box& box = boxes_[static_cast<std::size_t>(here)];
    if (away(box) >= best) continue;
    for (std::int32_t k = 0; k < box.count; ++k) {
      const Triangle& t = triangles_[static_cast<std::size_t>(box.first + k)];
      const Vector3d closest = closest_point(point, vertex(t, 0), vertex(t, 1), vertex(t, 2));
      const double squared = (closest - point).squaredNorm();
      if (!(squared < best)) continue;
      best = squared;
      found = closest;
    }
    if (box.count > 0) continue;
    const bool swap =
        away(boxes_[static_cast<std::size_t>(here + 1)]) < away(boxes_[static_cast<std::size_t>(box.first)]);
    stack[depth++] = swap ? box.first : here + 1;
    stack[depth++] = swap ? here + 1 : box.first;
  }
  return found;
}

std::size_t TriangleTree::bytes() const {
  return vertices_.size() * sizeof(vertices_[0]) + triangles_.size() * sizeof(Triangle) + boxes_.size() * sizeof(Box);
}

}  // namespace sparsha::bench
