// What the instruction guard counts: proxy updates, a projection, a window's load, each alone under valgrind.
// Everything that is not counted happens outside the functions named measured_*.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "haptics/proxy/proxy.h"
#include "haptics/window/window.h"
#include "tests/support/clouds.h"
#include "tests/support/scenes.h"
#include "tests/support/surfaces.h"

namespace {

using namespace sparsha;
using Eigen::Vector3d;

volatile double sink = 0.0;

/// 5000 ticks of a hand 2 mm under the source paper's sinusoid, a quarter of a cell per tick, with friction.
std::vector<Vector3d> hands() {
  std::vector<Vector3d> path;
  for (int k = 0; k < 5000; ++k) {
    const double t = k * 0.0036;
    const double x = 0.5 + 0.37 * std::sin(0.9 * t + 0.3), y = 0.5 + 0.33 * std::sin(1.3 * t);
    path.emplace_back(x, y, 0.05 * std::sin(2.0 * M_PI * x) * std::sin(2.0 * M_PI * y) - 0.002);
  }
  return path;
}

void follow(const haptics::MongeSurface& surface, const std::vector<Vector3d>& path, haptics::ProxyState& state,
            haptics::CellShape shape) {
  const haptics::SolverOptions options{.shape = shape};
  double sum = 0.0;
  for (const Vector3d& hand : path) sum += update_exact(surface, hand, state, options).position.z();
  sink = sum;
}

}  // namespace

extern "C" __attribute__((noinline)) void measured_proxy(const haptics::MongeSurface& surface,
                                                         const std::vector<Vector3d>& path,
                                                         haptics::ProxyState& state) {
  follow(surface, path, state, haptics::CellShape::rounded);
}

extern "C" __attribute__((noinline)) void measured_sharp(const haptics::MongeSurface& surface,
                                                         const std::vector<Vector3d>& path,
                                                         haptics::ProxyState& state) {
  follow(surface, path, state, haptics::CellShape::bilinear);
}

extern "C" __attribute__((noinline)) void measured_c1(const haptics::MongeSurface& surface,
                                                      const std::vector<Vector3d>& path, haptics::ProxyState& state) {
  follow(surface, path, state, haptics::CellShape::c1);
}

extern "C" __attribute__((noinline)) void measured_projection(const pipeline::Cloud& cloud) {
  scene::GridConfig grid;
  grid.spacing_m = 0.004;
  sink = test::project_cloud(cloud, grid, Eigen::Matrix4d::Identity(), 1).noise_m;
}

extern "C" __attribute__((noinline)) void measured_window(const scene::Scene& scene) {
  const auto plan = haptics::plan_window(scene.description(), 0, {0.2, 0.2}, 0.1);
  sink = haptics::load_window(scene, plan, 1).surface->highest_m;
}

int main(int argc, char** argv) {
  const std::string part = argc == 2 ? argv[1] : "";
  if (part == "proxy" || part == "sharp" || part == "c1") {
    haptics::MongeSurface surface = haptics::test::make_surface_of(200, 200, 1.0 / 199.0, [](double x, double y) {
      return 0.05 * std::sin(2.0 * M_PI * x) * std::sin(2.0 * M_PI * y);
    });
    haptics::test::set_friction(surface, 0.5, 0.4);
    const std::vector<Vector3d> path = hands();
    haptics::ProxyState state = start_proxy(surface, path.front());
    (part == "proxy" ? measured_proxy : part == "sharp" ? measured_sharp : measured_c1)(surface, path, state);
  } else if (part == "projection") {
    test::Points points;
    for (int j = 0; j < 300; ++j)
      for (int i = 0; i < 300; ++i) {
        const double x = 0.002 * i + 0.0007 * std::sin(12.9 * i + 78.2 * j),
                     y = 0.002 * j + 0.0007 * std::sin(39.3 * i);
        points.push_back({x, y, 0.01 * std::sin(9.0 * x) * std::cos(7.0 * y) + 0.0002 * std::sin(91.0 * i + 17.0 * j)});
      }
    measured_projection(test::make_cloud(points));
  } else if (part == "window") {
    measured_window(
        *test::scene_of([](double x, double y) { return 0.01 * std::sin(40.0 * x) * std::cos(30.0 * y); }, 801, 0.4));
  } else {
    std::fputs("usage: instruction_guard proxy|sharp|c1|projection|window\n", stderr);
    return 2;
  }
  std::printf("%g\n", static_cast<double>(sink));
  return 0;
}
