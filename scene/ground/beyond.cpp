#include "scene/ground/beyond.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "scene/ground/continuation.h"

namespace sparsha::scene {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMostHoleNodes = 64.0;  // wider holes are closed by the fill alone
constexpr double kAlongOutline = 10.0;   // slope at which a low edge lowers what lies beside it
constexpr double kBelowReach = 10.0;     // times as steep where no stroke over the edge reaches
constexpr double kSteepestEdge = 20.0;   // slopes that are trusted
constexpr double kSlopeFades_m = 0.001;  // device frame; away from the steepest edge nearby it is milder by one
constexpr int kFitReach = 3;             // nodes around an edge's node that tell its slope

struct Nodes {
  int nx = 0;
  int ny = 0;
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  [[nodiscard]] bool holds(int i, int j) const { return i >= 0 && j >= 0 && i < nx && j < ny; }
};

/// Lowers each value to the least of all values plus `step` times the way to them, along the lattice's eight directions
/// (two sweeps, Rosenfeld & Pfaltz 1966).
void spread(const Nodes& nodes, std::vector<double>& values, double step) {
  const double oblique = std::numbers::sqrt2 * step;
  const auto visit = [&](int i, int j, int back) {
    double& here = values[nodes.index(i, j)];
    const auto from = [&](int di, int dj, double way) {
      if (nodes.holds(i + di, j + dj)) here = std::min(here, values[nodes.index(i + di, j + dj)] + way);
    };
    from(-back, 0, step);
    from(-1, -back, oblique);
    from(0, -back, step);
    from(1, -back, oblique);
  };
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i) visit(i, j, 1);
  for (int j = nodes.ny - 1; j >= 0; --j)
    for (int i = nodes.nx - 1; i >= 0; --i) visit(i, j, -1);
}

/// In spacings, from each node to the nearest one in the set.
std::vector<double> distances(const Nodes& nodes, const std::vector<std::uint8_t>& set) {
  std::vector<double> distance(nodes.count(), kInfinite);
  for (std::size_t node = 0; node < distance.size(); ++node)
    if (set[node] != 0) distance[node] = 0.0;
  spread(nodes, distance, 1.0);
  return distance;
}

/// The closing of the known nodes by a disc: what is left is beyond.
std::vector<std::uint8_t> close(const Nodes& nodes, const std::vector<std::uint8_t>& known, double diameter) {
  const double radius = 0.5 * diameter;
  std::vector<std::uint8_t> far(nodes.count());
  const std::vector<double> to_known = distances(nodes, known);
  for (std::size_t node = 0; node < far.size(); ++node) far[node] = to_known[node] > radius ? 1 : 0;
  const std::vector<double> to_far = distances(nodes, far);
  std::vector<std::uint8_t> closed(nodes.count());
  for (std::size_t node = 0; node < closed.size(); ++node) closed[node] = known[node] != 0 || to_far[node] > radius;
  return closed;
}

/// How steeply the solid falls outwards at one of its nodes, 0 where it rises or is level: the plane through the solid
/// nodes around it, along the way from their middle to it.
double slope_outwards(const Nodes& nodes, const std::vector<float>& height_m, const std::vector<std::uint8_t>& solid,
                      int i, int j, double spacing_m) {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  const double z0 = static_cast<double>(height_m[nodes.index(i, j)]);
  for (int dj = -kFitReach; dj <= kFitReach; ++dj)
    for (int di = -kFitReach; di <= kFitReach; ++di) {
      if (!nodes.holds(i + di, j + dj) || solid[nodes.index(i + di, j + dj)] == 0) continue;
      const double h = static_cast<double>(height_m[nodes.index(i + di, j + dj)]) - z0;
      n += 1, x += di, y += dj, z += h;
      xx += di * di, xy += di * dj, yy += dj * dj, xz += di * h, yz += dj * h;
    }
  xx -= x * x / n, xy -= x * y / n, yy -= y * y / n, xz -= x * z / n, yz -= y * z / n;
  const double determinant = xx * yy - xy * xy;
  const double away = std::hypot(x, y);
  if (!(determinant > 1e-6 * (xx + yy) * (xx + yy)) || !(away > 0.0)) return 0.0;
  const double slope_x = (yy * xz - xy * yz) / determinant;
  const double slope_y = (xx * yz - xy * xz) / determinant;
  return std::clamp((slope_x * x + slope_y * y) / (away * spacing_m), 0.0, kSteepestEdge);
}

/// Device metres below an edge of slope `slope`, `way_m` beyond it (device frame): a parabola until it is steep, then
/// straight on, and below kFall_m so steep that whoever comes to the edge from beyond, deeper down, meets nothing
/// before.
double fall_m(double slope, double way_m) {
  if (way_m <= 0.0) return 0.0;
  const double bend_m = kEdgeRadius_m * std::max(0.0, kFallSlope - slope);
  const double bent_m = std::min(way_m, bend_m);
  const double fall =
      slope * bent_m + bent_m * bent_m / (2.0 * kEdgeRadius_m) + std::max(slope, kFallSlope) * (way_m - bent_m);
  return fall <= kFall_m ? fall : kFall_m + kBelowReach * (fall - kFall_m);
}

/// The same, with a felt rim before it as far as the edge is level.
double fall_after_rim_m(double slope, double way_m) {
  const double share = std::max(0.0, 1.0 - slope / kFallSlope);
  const double width_m = share * kRimWidth_m;
  if (way_m >= width_m) return fall_m(slope, way_m - 0.5 * width_m);
  const double wave = std::sin(std::numbers::pi * way_m / width_m);
  return fall_m(slope, way_m - 0.5 * width_m) - share * kRim_m * wave * wave;
}

double hole_nodes(const BeyondOptions& options) {
  const double hole_m = std::max(options.hole_m, kHoleAtHand_m / options.scale);
  return std::clamp(hole_m / options.spacing_m, kHoleNodes, kMostHoleNodes);
}

}  // namespace

int hole_margin(const BeyondOptions& options) {
  if (options.kind == HapticsConfig::Beyond::continued) return 0;
  return static_cast<int>(std::ceil(hole_nodes(options))) + 1;
}

int fall_nodes(const BeyondOptions& options) {
  if (options.kind == HapticsConfig::Beyond::continued) return 0;
  constexpr double kMost = 1024.0;
  // A parabola to kFallSlope, then straight on: kFall_m / kFallSlope, and half of what the bend takes.
  constexpr double kWay_m = kFall_m / kFallSlope + 0.5 * kEdgeRadius_m * kFallSlope + kRimWidth_m;
  return static_cast<int>(std::min(std::ceil(kWay_m / (options.scale * options.spacing_m)), kMost)) + 2;
}

// f(x) = min over the edge's nodes e of (z_e + s |x - e|) - s d(x) - fall(d(x)), d the way to the nearest one: z_e less
// the fall where e is the nearest and no lower edge lies beside it, and without a step from one edge to another.
void continue_beyond(std::vector<float>& height_m, int nx, int ny, const BeyondOptions& options) {
  const Nodes nodes{nx, ny};
  std::vector<std::uint8_t> known(nodes.count());
  for (std::size_t node = 0; node < known.size(); ++node) known[node] = std::isfinite(height_m[node]) ? 1 : 0;
  const auto count = std::count(known.begin(), known.end(), std::uint8_t{1});
  if (static_cast<std::size_t>(count) == known.size()) return;
  if (count == 0 || options.kind == HapticsConfig::Beyond::continued) return continue_heights(height_m, nx, ny);
  const std::vector<std::uint8_t> solid = close(nodes, known, hole_nodes(options));
  continue_heights(height_m, nx, ny);
  if (std::find(solid.begin(), solid.end(), std::uint8_t{0}) == solid.end()) return;

  std::vector<double> edge_m(nodes.count(), kInfinite);
  double lowest_m = kInfinite;
  std::vector<double> steepness(nodes.count(), kInfinite);  // less is steeper
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (solid[nodes.index(i, j)] == 0) continue;
      bool at_edge = false;
      for (const auto& [di, dj] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
        at_edge = at_edge || (nodes.holds(i + di, j + dj) && solid[nodes.index(i + di, j + dj)] == 0);
      if (!at_edge) continue;
      edge_m[nodes.index(i, j)] = static_cast<double>(height_m[nodes.index(i, j)]);
      lowest_m = std::min(lowest_m, edge_m[nodes.index(i, j)]);
      steepness[nodes.index(i, j)] = -slope_outwards(nodes, height_m, solid, i, j, options.spacing_m);
    }
  const std::vector<double> way = distances(nodes, solid);
  const double fade = options.spacing_m * options.scale / kSlopeFades_m;
  spread(nodes, edge_m, kAlongOutline * options.spacing_m);
  spread(nodes, steepness, fade);
  const auto fall = options.kind == HapticsConfig::Beyond::rim ? fall_after_rim_m : fall_m;
  for (std::size_t node = 0; node < solid.size(); ++node) {
    if (solid[node] != 0) continue;
    const double way_m = way[node] * options.spacing_m;
    const double slope = std::max(0.0, fade * way[node] - steepness[node]);
    const double lower_m = kAlongOutline * way_m + fall(slope, options.scale * way_m) / options.scale;
    height_m[node] = static_cast<float>(std::max(edge_m[node] - lower_m, lowest_m - kFall_m / options.scale));
  }
}

}  // namespace sparsha::scene
