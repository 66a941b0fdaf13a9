// A hand that is pushed deep into whole objects, through thin walls, over sharp edges and out again: what it feels from
// one tick to the next beyond what its own motion explains, and what its energy account says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/smooth_step.h"
#include "tests/support/driven_hand.h"
#include "tests/support/touch_loop.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

bool night() { return std::getenv("SPARSHA_NIGHTLY") != nullptr; }

/// A plate about the origin, `half_nodes` thick to either side.
scene::Charts plate_charts(double half_thickness_m, int half_nodes = 30, double spacing_m = 0.001) {
  const double half_m = half_nodes * spacing_m;
  scene::Charts charts = charts_of(
      [&](scene::Side side, double, double v) -> std::optional<SeenSurface> {
        const bool face = side == scene::Side::front || side == scene::Side::back;
        if (!face && std::abs(v) > half_thickness_m && (side == scene::Side::right || side == scene::Side::left))
          return std::nullopt;
        return SeenSurface{face ? half_thickness_m : half_m, 0.0, 0.0};
      },
      half_nodes, spacing_m);
  // Narrow sides: only the strip that is there.
  for (scene::Sheet& sheet : charts.sheets) {
    if (sheet.side == scene::Side::front || sheet.side == scene::Side::back) continue;
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i) {
        const std::size_t node = sheet.index(i, j);
        const Vector3d p = charts.place_m(sheet, i, j);
        if (std::abs(p.z()) <= half_thickness_m + 1e-9) continue;
        sheet.mask[node] = 0;
        sheet.height_m[node] = sheet.slope_u[node] = sheet.slope_v[node] = std::nanf("");
      }
    for (int j = 0; j + 1 < sheet.ny; ++j)
      for (int i = 0; i + 1 < sheet.nx; ++i)
        if (!(sheet.measured(sheet.index(i, j)) && sheet.measured(sheet.index(i + 1, j)) &&
              sheet.measured(sheet.index(i, j + 1)) && sheet.measured(sheet.index(i + 1, j + 1))))
          sheet.mask[sheet.index(i, j)] &= scene::Sheet::kMeasured;
  }
  return charts;
}

struct Kicks {
  std::uint64_t ticks = 0, contacts = 0, released = 0, bad = 0;
  double worst_n = 0.0;  ///< beyond three times what the hand's way explains, of the commanded force
  double raw_n = 0.0;    ///< the same of the force before the governor
};

/// Goes between random places in and about the object at up to `speed` metres a second, at 1 kHz. `smooth`: it begins
/// and ends each way at rest, as a person does; else it turns within a tick.
Kicks push_about(const scene::ScenePointer& scene, double reach_m, double speed_m_per_s, bool smooth, int ticks,
                 std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Driven hand(window_of(scene));
  hand.stay(2);
  Kicks kicks;
  Vector3d at(0.0, 0.0, 0.03), last_n = Vector3d::Zero(), last_raw_n = Vector3d::Zero();
  while (kicks.ticks < static_cast<std::uint64_t>(ticks)) {
    const Vector3d middle = hand.to_device(Vector3d::Zero());
    const Vector3d to = middle + reach_m * Vector3d(uniform(random), uniform(random), uniform(random));
    const double step_m = 0.001 * speed_m_per_s * std::exp(-2.0 * std::abs(uniform(random)));
    const int steps = std::max(1, static_cast<int>((to - at).norm() / step_m));
    const Vector3d from = at;
    for (int k = 1; k <= steps; ++k) {
      const Vector3d before = at;
      const double share = static_cast<double>(k) / steps;
      at = from + (to - from) * (smooth ? smooth_step(share) : share);
      hand.at(at);
      const haptics::State& s = hand.state();
      const Vector3d now_n = vector(s.commanded_force_n), raw_n = vector(s.force_n);
      const double explained_n = 3.0 * s.stiffness_n_per_m * (at - before).norm();
      ++kicks.ticks;
      kicks.contacts += s.contact;
      if (!now_n.allFinite() || now_n.norm() > 8.0 + 1e-9) ++kicks.bad;
      kicks.worst_n = std::max(kicks.worst_n, (now_n - last_n).norm() - explained_n);
      kicks.raw_n = std::max(kicks.raw_n, (raw_n - last_raw_n).norm() - explained_n);
      last_n = now_n;
      last_raw_n = raw_n;
    }
  }
  return kicks;
}

TEST(ObjectKicks, NoHandIsKickedDeepInsideThroughWallsOrOverEdges) {
  struct Case {
    const char* name;
    scene::ScenePointer scene;
    double reach_m;
  };
  const std::vector<Case> cases{
      {"ball", whole_scene(ball_charts()), 0.05},
      {"cube", whole_scene(cube_charts()), 0.04},
      {"plate of 3 cells", whole_scene(plate_charts(0.0015)), 0.035},
      {"plate of 10 cells", whole_scene(plate_charts(0.005)), 0.035},
      {"ball without its back", whole_scene(ball_charts(0.04, 0.001, scene::Side::back)), 0.05}};
  // Hands that no force stops.
  constexpr double kMost_n = 0.05;
  constexpr double kSmooth_n = 0.1, kAbrupt_n = 0.4;  // of the fastest over a night
  const std::vector<std::pair<double, bool>> hands{{0.01, false}, {0.1, false}, {0.5, false}, {0.1, true}, {0.5, true}};
  for (const Case& c : cases)
    for (const auto& [speed, smooth] : hands) {
      const Kicks kicks = push_about(c.scene, c.reach_m, speed, smooth, night() ? 2'000'000 : 40'000, 7);
      const std::string all = std::string(c.name) + " at " + std::to_string(speed) +
                              (smooth ? " m/s, smoothly: " : " m/s: ") + std::to_string(kicks.ticks) + " ticks, " +
                              std::to_string(kicks.contacts) + " in contact, " + std::to_string(kicks.bad) +
                              " bad, kick " + std::to_string(kicks.worst_n) + " N, before the fade " +
                              std::to_string(kicks.raw_n);
      if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
      EXPECT_EQ(kicks.bad, 0U) << all;
      EXPECT_GT(kicks.contacts, kicks.ticks / 50) << all;
      const bool fast = speed > 0.2 && night();
      EXPECT_LE(kicks.worst_n, !fast ? kMost_n : smooth ? kSmooth_n : kAbrupt_n) << all;
    }
}

TEST(ObjectEnergy, HandsOnSeamsAndEdgesGetNoMoreThanTenMillijoules) {
  struct Case {
    const char* name;
    scene::ScenePointer scene;
    Ground ground;
    Quaterniond turn;
  };
  const double eighth = 0.785398163397448;
  const Quaterniond quarter(Eigen::AngleAxisd(eighth, Vector3d::UnitY()));
  const Quaterniond corner(Eigen::AngleAxisd(0.615479708670387, Vector3d::UnitX()) *
                           Eigen::AngleAxisd(eighth, Vector3d::UnitY()));
  const scene::ScenePointer ball = whole_scene(ball_charts(0.08)), cube = whole_scene(cube_charts());
  const std::vector<Case> cases{{"ball, one side", ball, Ground::sphere, Quaterniond::Identity()},
                                {"ball, a seam", ball, Ground::sphere, quarter},
                                {"ball, three seams", ball, Ground::sphere, corner},
                                {"cube, a face", cube, Ground::plane, Quaterniond::Identity()},
                                {"cube, an edge", cube, Ground::plane, quarter},
                                {"cube, a corner", cube, Ground::plane, corner}};
  const int loops = night() ? 100 : 5;
  for (const Case& c : cases) {
    std::mt19937_64 random(17);
    const auto among = [&](double low, double high) {
      return low + (high - low) * std::generate_canonical<double, 53>(random);
    };
    double worst_j = 0.0, least_swing_m = 1.0;
    int above = 0, faults = 0;
    for (int k = 0; k < loops; ++k) {
      TouchCase loop;
      loop.ground = c.ground;
      loop.stroke = k % 4 != 0;
      loop.mass_kg = among(0.05, 0.3);
      loop.damping_n_s_per_m = among(2.0, 6.0);
      loop.grip_n_per_m = among(150.0, 600.0);
      loop.wish_n_per_m = among(300.0, 2000.0);
      loop.rate_hz = loop.configured_hz = k % 2 == 0 ? 1000.0 : 2000.0;
      loop.declared_ticks = 1 + k % 3;
      loop.delay_s = loop.declared_ticks / loop.rate_hz;
      loop.jitter_s = k % 5 == 1 ? 0.0003 : 0.0;
      loop.lost = k % 5 == 2 ? 0.03 : 0.0;
      loop.duration_s = 6.0;
      loop.seed = static_cast<std::uint64_t>(k) + 1;
      int ticks = 0, touched = 0;
      const TouchResult result = touch(
          loop, window_of(c.scene),
          [&](const haptics::DeviceSample&, const haptics::Record& record) {
            ++ticks;
            touched += record.state.contact != 0 ? 1 : 0;
          },
          [&](haptics::HapticRenderer& renderer) { turn(renderer, c.turn); });
      EXPECT_GT(12 * touched, ticks) << c.name << ", " << k;
      worst_j = std::max(worst_j, result.delivered_j);
      above += result.delivered_j > 0.010 ? 1 : 0;
      faults += result.fault ? 1 : 0;
      least_swing_m = std::min(least_swing_m, result.swing_m);
    }
    const std::string all = std::string(c.name) + ": worst " + std::to_string(1000.0 * worst_j) + " mJ, " +
                            std::to_string(above) + " of " + std::to_string(loops) + " above ten, " +
                            std::to_string(faults) + " faults";
    if (std::getenv("SPARSHA_FIGURES") != nullptr) std::printf("%s\n", all.c_str());
    EXPECT_EQ(above, 0) << all;
  }
}

}  // namespace
}  // namespace sparsha::test
