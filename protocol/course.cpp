#include "protocol/course.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "protocol/path.h"

namespace sparsha::protocol {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Largest curvature of tops, by differences of the slope on a fine raster.
double top_curvature(const Ground& ground, double margin_m) {
  constexpr int kSamples = 400;
  constexpr double kStep_m = 1e-4;
  double most = 1e-9;
  for (int j = 0; j <= kSamples; ++j)
    for (int i = 0; i <= kSamples; ++i) {
      const double x = margin_m + (1.0 - 2.0 * margin_m) * i / kSamples;
      const double y = margin_m + (1.0 - 2.0 * margin_m) * j / kSamples;
      const Vector2d along_x = (ground.slope(x + kStep_m, y) - ground.slope(x - kStep_m, y)) / (2.0 * kStep_m);
      const Vector2d along_y = (ground.slope(x, y + kStep_m) - ground.slope(x, y - kStep_m)) / (2.0 * kStep_m);
      const double mean = 0.5 * (along_x.x() + along_y.y());
      const double half = 0.5 * (along_x.x() - along_y.y());
      const double least = mean - std::hypot(half, along_x.y());
      most = std::max(most, -least / std::sqrt(1.0 + ground.slope(x, y).squaredNorm()));
    }
  return most;
}

struct Wave {
  Vector2d k;
  double phase;
  double amplitude;
};

Ground stone() {
  std::mt19937_64 random(17);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Wave> waves;
  for (double frequency = 2.0; frequency <= 32.0; frequency *= 2.0)
    for (int n = 0; n < 3; ++n) {
      const double direction = kTurn * uniform();
      waves.push_back({kTurn * frequency * Vector2d(std::cos(direction), std::sin(direction)), kTurn * uniform(),
                       0.0008 * std::pow(32.0 / frequency, 0.9)});
    }
  Ground ground;
  ground.name = "stone";
  ground.height = [waves](double x, double y) {
    double z = 0.0;
    for (const Wave& w : waves) z += w.amplitude * std::sin(w.k.dot(Vector2d(x, y)) + w.phase);
    return z;
  };
  ground.slope = [waves](double x, double y) {
    Vector2d slope = Vector2d::Zero();
    for (const Wave& w : waves) slope += w.amplitude * std::cos(w.k.dot(Vector2d(x, y)) + w.phase) * w.k;
    return slope;
  };
  return ground;
}

/// A profile across a direction oblique to the grid; the path crosses its middle 60 mm from its start.
Ground profile(const std::string& name, double (*height)(double), double (*slope)(double)) {
  const Vector2d across(std::cos(0.4), std::sin(0.4));
  const auto at = [across](double x, double y) { return across.dot(Vector2d(x - 0.645, y - 0.548)); };
  Ground ground;
  ground.name = name;
  ground.height = [at, height](double x, double y) { return height(at(x, y)); };
  ground.slope = [at, slope, across](double x, double y) { return Vector2d(slope(at(x, y)) * across); };
  return ground;
}

}  // namespace

double deepest_m(const Ground& ground, double margin_m) { return 0.7 / top_curvature(ground, margin_m); }

std::vector<Ground> all_grounds() {
  std::vector<Ground> grounds;
  Ground ground;
  ground.name = "sinusoid";
  ground.height = [](double x, double y) { return 0.05 * std::sin(kTurn * x) * std::sin(kTurn * y); };
  ground.slope = [](double x, double y) {
    return Vector2d(0.05 * kTurn * std::cos(kTurn * x) * std::sin(kTurn * y),
                    0.05 * kTurn * std::sin(kTurn * x) * std::cos(kTurn * y));
  };
  grounds.push_back(ground);
  ground.name = "plane";
  ground.height = [](double x, double y) { return 0.3 * x + 0.2 * y - 0.25; };
  ground.slope = [](double, double) { return Vector2d(0.3, 0.2); };
  grounds.push_back(ground);
  ground.name = "cap";
  ground.height = [](double x, double y) {
    return std::sqrt(1.0 - (x - 0.5) * (x - 0.5) - (y - 0.5) * (y - 0.5)) - 0.85;
  };
  ground.slope = [](double x, double y) {
    const Vector2d from(x - 0.5, y - 0.5);
    return Vector2d(-from / std::sqrt(1.0 - from.squaredNorm()));
  };
  grounds.push_back(ground);
  grounds.push_back(profile(
      "ridge", [](double u) { return 0.1 - 0.5 * std::hypot(u, 0.02); },
      [](double u) { return -0.5 * u / std::hypot(u, 0.02); }));
  grounds.push_back(profile(
      "step", [](double u) { return 0.01 * std::tanh(u / 0.01); },
      [](double u) { return 1.0 / (std::cosh(u / 0.01) * std::cosh(u / 0.01)); }));
  grounds.push_back(stone());
  for (Ground& each : grounds) each.most_depth_m = deepest_m(each);
  return grounds;
}

haptics::MongeSurface sample(const Ground& ground, int nodes_per_side) {
  haptics::MongeSurface surface;
  surface.lattice.nx = surface.lattice.ny = nodes_per_side;
  surface.lattice.spacing_m = 1.0 / (nodes_per_side - 1);
  surface.height_m.reserve(surface.lattice.count());
  for (int j = 0; j < nodes_per_side; ++j)
    for (int i = 0; i < nodes_per_side; ++i)
      surface.height_m.push_back(
          static_cast<float>(ground.height(i * surface.lattice.spacing_m, j * surface.lattice.spacing_m)));
  return surface;
}

Course make_course(const Ground& ground, double metres_per_tick, double depth_m, int ticks) {
  constexpr int kDown = 50;          // ticks
  constexpr double kStart_m = 0.01;  // above
  Course course;
  course.first = kDown;
  for (int tick = -kDown; tick < ticks; ++tick) {
    const Vector2d place = place_on_path(std::max(0, tick) * metres_per_tick / kPathSpeed);
    const double x = place.x(), y = place.y();
    const Vector2d slope = ground.slope(x, y);
    const Vector3d normal = Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
    const double down = std::min(1.0, 1.0 + static_cast<double>(tick + 1) / kDown);
    course.feet.emplace_back(x, y, ground.height(x, y));
    course.hands.push_back(course.feet.back() + (kStart_m * (1.0 - down) - depth_m * down) * normal);
  }
  return course;
}

}  // namespace sparsha::protocol
