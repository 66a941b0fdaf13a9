// Analytic scenes for the viewer's tests.
#include "tests/viewer/relief_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::viewer::test {

double lotus(double x_m, double y_m) {
  const double x = (x_m - 0.2) / 0.2, y = (y_m - 0.2) / 0.2;
  const double r = std::hypot(x, y), a = std::atan2(y, x);
  const double edge = std::max(std::abs(x), std::abs(y));
  double h = 0.0;
  const auto bump = [](double t) { return t > -1.0 && t < 1.0 ? 0.5 + 0.5 * std::cos(std::numbers::pi * t) : 0.0; };
  for (int ring = 0; ring < 2; ++ring) {
    const int petals = ring == 0 ? 8 : 16;
    const double inner = ring == 0 ? 0.14 : 0.40, outer = ring == 0 ? 0.44 : 0.74;
    const double phase = a * petals / (2.0 * std::numbers::pi) + (ring == 0 ? 0.0 : 0.5);
    const double across = 2.0 * (phase - std::round(phase));
    const double along = (r - inner) / (outer - inner);
    if (along > 0.0 && along < 1.0) {
      const double width =
          std::sqrt(std::max(0.0, 1.0 - std::pow(std::abs(along - 0.35) / (along < 0.35 ? 0.6 : 0.65), 2.0)));
      const double petal = std::max(0.0, 1.0 - std::pow(across / std::max(width, 1e-3), 2.0));
      h = std::max(h, 0.012 * std::sqrt(petal) * (1.0 - 0.35 * along) - 0.003 * std::exp(-80.0 * across * across));
    }
  }
  h = std::max(h, r < 0.15 ? 0.010 * std::sqrt(std::max(0.0, 1.0 - r * r / 0.0225)) + 0.004 : 0.0);
  h += 0.005 * bump((r - 0.80) / 0.04);
  h += 0.007 * bump((edge - 0.93) / 0.05);
  // Grain of a rough stone: value noise in four octaves, smooth and repeatable.
  const auto hash = [](int i, int j) {
    unsigned k = static_cast<unsigned>(i) * 374761393U + static_cast<unsigned>(j) * 668265263U;
    k = (k ^ (k >> 13)) * 1274126177U;
    return static_cast<double>(k ^ (k >> 16)) / 4294967295.0 - 0.5;
  };
  double frequency = 18.0, amplitude = 0.0007;
  for (int octave = 0; octave < 5; ++octave, frequency *= 2.0, amplitude *= 0.55) {
    const double u = frequency * (x + 2.0), v = frequency * (y + 2.0);
    const int i = static_cast<int>(u), j = static_cast<int>(v);
    const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double s = ease(u - i), t = ease(v - j);
    h += amplitude * ((1 - t) * ((1 - s) * hash(i, j) + s * hash(i + 1, j)) +
                      t * ((1 - s) * hash(i, j + 1) + s * hash(i + 1, j + 1)));
  }
  return h;
}

haptics::State touching(const scene::Scene& scene, double x_m, double y_m, double z_m, double cx_m, double cy_m) {
  const scene::SceneDescription& description = scene.description();
  haptics::State state;
  state.tick = 1000;
  state.time_s = 1.0;
  const scene::Lattice& level = description.levels.front();
  const int nodes = std::min(description.config.levels.window, std::max(level.nx, level.ny));
  state.window = {0, 0, nodes, nodes};
  state.workspace_m = 0.1;
  state.scale = 0.1 / ((nodes - 1) * level.spacing_m);
  state.centre_m = {cx_m, cy_m, z_m};
  state.proxy_m = state.place_m = {x_m, y_m, z_m};
  state.hip_m = {x_m, y_m, z_m - 0.002 / state.scale};
  state.normal = {0.0, 0.0, 1.0};
  state.force_n = state.commanded_force_n = {0.2, 0.1, 1.6};
  state.penetration_m = 0.002;
  state.contact = 1;
  state.friction_coefficient = 0.42;
  state.flags = haptics::kFlagTexture | haptics::kFlagFriction | haptics::kFlagArmed;
  return state;
}

}  // namespace sparsha::viewer::test
