#include "bench/haptics/scenes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include "haptics/surface/large_pages.h"
#include "protocol/path.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using haptics::MongeSurface;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kHeight_m = 0.05;
constexpr double kDepth_m = 0.002;

double sinusoid(double x, double y) { return kHeight_m * std::sin(kTurn * x) * std::sin(kTurn * y); }

Vector3d sinusoid_normal(double x, double y) {
  return Vector3d(-kHeight_m * kTurn * std::cos(kTurn * x) * std::sin(kTurn * y),
                  -kHeight_m * kTurn * std::sin(kTurn * x) * std::cos(kTurn * y), 1.0)
      .normalized();
}

/// In memory as make_surface() takes it.
std::vector<float> values_for(const MongeSurface& surface) {
  std::vector<float> values = haptics::reserve_large(surface.lattice.count());
  values.resize(surface.lattice.count());
  return values;
}

MongeSurface empty_surface(int nodes) {
  MongeSurface surface;
  surface.lattice.nx = surface.lattice.ny = nodes;
  surface.lattice.spacing_m = 1.0 / (nodes - 1);
  surface.height_m = values_for(surface);
  return surface;
}

/// A coefficient that wanders between 0.2 and 0.6 over some ten cells.
void add_friction(MongeSurface& surface) {
  surface.mu_dynamic = values_for(surface);
  surface.mu_static = values_for(surface);
  for (int j = 0; j < surface.lattice.ny; ++j)
    for (int i = 0; i < surface.lattice.nx; ++i) {
      const std::size_t node = surface.lattice.index(i, j);
      const double mu = 0.4 + 0.2 * std::sin(0.6 * i) * std::cos(0.5 * j);
      surface.mu_dynamic[node] = static_cast<float>(mu);
      surface.mu_static[node] = std::max(0.4F, surface.mu_dynamic[node]);
    }
}

/// Points of the path whose mean distance is `cells_per_tick`.
std::vector<Vector2d> path(int nodes, double cells_per_tick, int ticks) {
  const double dt = cells_per_tick / (nodes - 1) / protocol::kPathSpeed;
  std::vector<Vector2d> points;
  for (int k = 0; k < ticks; ++k) points.push_back(protocol::place_on_path(k * dt));
  return points;
}

double mean_cells(const std::vector<Vector2d>& points, int nodes) {
  double length = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k) length += (points[k] - points[k - 1]).norm();
  return length * (nodes - 1) / static_cast<double>(points.size() - 1);
}

std::vector<double> midpoint_displacement(int size, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto count = static_cast<std::size_t>(size);
  std::vector<double> z(count * count, 0.0);
  const auto at = [&](int i, int j) -> double& {
    return z[static_cast<std::size_t>(j) * count + static_cast<std::size_t>(i)];
  };
  double sigma = 1.0;
  for (int step = size - 1; step > 1; step /= 2) {
    const int half = step / 2;
    for (int j = half; j < size; j += step)
      for (int i = half; i < size; i += step)
        at(i, j) =
            0.25 * (at(i - half, j - half) + at(i + half, j - half) + at(i - half, j + half) + at(i + half, j + half)) +
            sigma * normal(random);
    for (int j = 0; j < size; j += half)
      for (int i = (j / half) % 2 == 0 ? half : 0; i < size; i += step) {
        const int left = std::max(i - half, 0);
        const int right = std::min(i + half, size - 1);
        const int low = std::max(j - half, 0);
        const int high = std::min(j + half, size - 1);
        at(i, j) = 0.25 * (at(left, j) + at(right, j) + at(i, low) + at(i, high)) + 0.7 * sigma * normal(random);
      }
    sigma *= std::pow(2.0, -0.7);
  }
  return z;
}

}  // namespace

HapticScene sinusoid_scene(int nodes, double cells_per_tick, int ticks, bool friction) {
  HapticScene scene;
  scene.name = "sinusoid";
  scene.surface = empty_surface(nodes);
  for (int j = 0; j < nodes; ++j)
    for (int i = 0; i < nodes; ++i)
      scene.surface.height_m[scene.surface.lattice.index(i, j)] =
          static_cast<float>(sinusoid(i * scene.surface.lattice.spacing_m, j * scene.surface.lattice.spacing_m));
  if (friction) add_friction(scene.surface);
  const std::vector<Vector2d> points = path(nodes, cells_per_tick, ticks);
  scene.cells_per_tick = mean_cells(points, nodes);
  for (const Vector2d& p : points) {
    const Vector3d foot(p.x(), p.y(), sinusoid(p.x(), p.y()));
    scene.truth.push_back(foot);
    scene.hands.push_back(foot - kDepth_m * sinusoid_normal(p.x(), p.y()));
  }
  if (friction) scene.truth.clear();
  return scene;
}

HapticScene stone_scene(int nodes, double cells_per_tick, int ticks, bool friction, unsigned seed) {
  HapticScene scene;
  scene.name = "stone";
  scene.surface = empty_surface(nodes);
  int size = 2;
  while (size + 1 < nodes) size *= 2;
  std::mt19937_64 random(seed);
  const std::vector<double> z = midpoint_displacement(size + 1, random);
  double squared = 0.0;
  for (int j = 0; j + 1 < nodes; ++j)
    for (int i = 0; i + 1 < nodes; ++i) {
      const auto node = static_cast<std::size_t>(j) * static_cast<std::size_t>(size + 1) + static_cast<std::size_t>(i);
      squared += (z[node + 1] - z[node]) * (z[node + 1] - z[node]);
    }
  const double cell = scene.surface.lattice.spacing_m;
  const double scale = cell / std::sqrt(squared / (static_cast<double>(nodes - 1) * (nodes - 1)));
  for (int j = 0; j < nodes; ++j)
    for (int i = 0; i < nodes; ++i)
      scene.surface.height_m[scene.surface.lattice.index(i, j)] = static_cast<float>(
          scale * z[static_cast<std::size_t>(j) * static_cast<std::size_t>(size + 1) + static_cast<std::size_t>(i)]);
  if (friction) add_friction(scene.surface);
  const std::vector<Vector2d> points = path(nodes, cells_per_tick, ticks);
  scene.cells_per_tick = mean_cells(points, nodes);
  for (const Vector2d& p : points)
    scene.hands.push_back({p.x(), p.y(), scene.surface.height(p.x(), p.y()) - 2.0 * cell});
  return scene;
}

}  // namespace sparsha::bench
