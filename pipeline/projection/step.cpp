// Closest points of two convex hulls in the plane (Gilbert, Johnson & Keerthi 1988).
#include "pipeline/projection/step.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace sparsha::pipeline {
namespace {

struct Vector {
  double u = 0.0, v = 0.0;
};

// Hulls nearer than a ten-thousandth of a spacing touch; so few rounds are never needed in the plane.
constexpr double kTouching2 = 1e-8;
constexpr int kRounds = 32;

Vector minus(Vector a, Vector b) { return {a.u - b.u, a.v - b.v}; }
double dot(Vector a, Vector b) { return a.u * b.u + a.v * b.v; }

Vector at(const NodePoint& p) { return {static_cast<double>(p.u), static_cast<double>(p.v)}; }

// The point of a set that is extreme against direction d.
Vector lowest(std::span<const NodePoint> set, Vector d) {
  Vector best = at(set.front());
  double least = dot(best, d);
  for (const NodePoint& p : set) {
    const double value = dot(at(p), d);
    if (value < least) {
      least = value;
      best = at(p);
    }
  }
  return best;
}

// The point of segment pq nearest zero.
Vector nearest_on_segment(Vector p, Vector q) {
  const Vector d = minus(q, p);
  const double length2 = dot(d, d);
  const double t = length2 > 0.0 ? std::fmin(1.0, std::fmax(0.0, -dot(p, d) / length2)) : 0.0;
  return {p.u + t * d.u, p.v + t * d.v};
}

// Nearest point of the simplex to zero; leaves the corners that span it. False when zero is inside a triangle.
bool nearest_to_zero(std::array<Vector, 3>& simplex, std::size_t& corners, Vector& w) {
  if (corners == 2) {
    w = nearest_on_segment(simplex[0], simplex[1]);
    return true;
  }
  const auto cross = [](Vector p, Vector q) { return p.u * q.v - p.v * q.u; };
  const double c0 = cross(simplex[0], simplex[1]);
  const double c1 = cross(simplex[1], simplex[2]);
  const double c2 = cross(simplex[2], simplex[0]);
  if ((c0 > 0.0 && c1 > 0.0 && c2 > 0.0) || (c0 < 0.0 && c1 < 0.0 && c2 < 0.0)) return false;
  const std::array<Vector, 3> edges{nearest_on_segment(simplex[0], simplex[1]),
                                    nearest_on_segment(simplex[1], simplex[2]),
                                    nearest_on_segment(simplex[2], simplex[0])};
  std::size_t best = 0;
  for (std::size_t e = 1; e < 3; ++e) {
    if (dot(edges[e], edges[e]) < dot(edges[best], edges[best])) best = e;
  }
  w = edges[best];
  simplex = {simplex[best], simplex[(best + 1) % 3], Vector{}};
  corners = 2;
  return true;
}

}  // namespace

Separation separate(std::span<const NodePoint> a, std::span<const NodePoint> b) {
  Separation result;
  if (a.empty() || b.empty()) return result;
  // The simplex holds points of the difference a - b; w is its point nearest zero.
  std::array<Vector, 3> simplex;
  std::size_t corners = 1;
  simplex[0] = minus(at(a.front()), at(b.front()));
  Vector w = simplex[0];
  for (int round = 0; round < kRounds; ++round) {
    const double length2 = dot(w, w);
    if (length2 < kTouching2) return {};
    const Vector near_a = lowest(a, w);
    const Vector near_b = lowest(b, {-w.u, -w.v});
    const Vector next = minus(near_a, near_b);
    const double gap = dot(next, w);  // between the sets along w, times |w|
    const double length = std::sqrt(length2);
    if (gap / length > result.margin) {
      result.separable = true;
      result.margin = gap / length;
      result.node_side = -0.5 * (dot(near_a, w) + dot(near_b, w)) / length;
      result.u = w.u / length;
      result.v = w.v / length;
    }
    if (length2 - gap < 1e-6 * length2) return result;
    simplex[corners++] = next;
    if (!nearest_to_zero(simplex, corners, w)) return {};
  }
  return result;
}

}  // namespace sparsha::pipeline
