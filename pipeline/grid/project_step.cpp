// Closest points of two convex hulls by the Mitchell-Demyanov-Malozemov step of Frank and Wolfe's method.
#include "pipeline/grid/project_step.h"

#include <cmath>

namespace sparsha::pipeline {
namespace {

struct Vector {
  double u = 0.0, v = 0.0;
};

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

}  // namespace

Separation separate(std::span<const NodePoint> a, std::span<const NodePoint> b) {
  Separation result;
  if (a.empty() || b.empty()) return result;
  // w runs through the difference of the hulls towards its point nearest zero; pa - pb = w.
  Vector pa;
  Vector pb;
  for (const NodePoint& p : a) pa = {pa.u + at(p).u, pa.v + at(p).v};
  for (const NodePoint& p : b) pb = {pb.u + at(p).u, pb.v + at(p).v};
  pa = {pa.u / static_cast<double>(a.size()), pa.v / static_cast<double>(a.size())};
  pb = {pb.u / static_cast<double>(b.size()), pb.v / static_cast<double>(b.size())};
  for (int round = 0; round < 24; ++round) {
    const Vector w{pa.u - pb.u, pa.v - pb.v};
    const double length2 = dot(w, w);
    // Hulls that come so near overlap, or nearly so: no line that could be trusted parts them.
    if (length2 < 1e-4) return result;
    const Vector near_a = lowest(a, w);
    const Vector near_b = lowest(b, {-w.u, -w.v});
    const double gap = dot(near_a, w) - dot(near_b, w);  // of the sets along w, times |w|
    if (gap > 0.0) {
      const double width = gap / std::sqrt(length2);
      if (width > result.margin) {
        result.separable = true;
        result.margin = width;
        result.node_side = -0.5 * (dot(near_a, w) + dot(near_b, w)) / std::sqrt(length2);
      }
      if (length2 - gap < 1e-3 * length2) return result;
    }
    const Vector step{near_a.u - near_b.u - w.u, near_a.v - near_b.v - w.v};
    const double step2 = dot(step, step);
    if (step2 < 1e-14) return result;
    const double t = std::fmin(1.0, -dot(w, step) / step2);
    if (!(t > 0.0)) return result;
    pa = {pa.u + t * (near_a.u - pa.u), pa.v + t * (near_a.v - pa.v)};
    pb = {pb.u + t * (near_b.u - pb.u), pb.v + t * (near_b.v - pb.v)};
  }
  return result;
}

}  // namespace sparsha::pipeline
