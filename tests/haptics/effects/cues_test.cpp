// Ticks as the motors get them: one for each thing that the hand comes to, light, and none for what is turned off.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <vector>

#include "haptics/effects/cues.h"
#include "haptics/effects/surface_effects.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics {
namespace {

using scene::Cue;

constexpr double kWidth_m = 0.1;

/// A level stone of 0.1 m, a part from x = 40 to 60 mm, and from 80 mm on nothing measured.
scene::ScenePointer stone(const std::optional<scene::CuesConfig>& cues) {
  return sparsha::test::scene_of([](double x, double) { return x < 0.0801 ? 0.0 : std::nan(""); }, 201, kWidth_m, 201,
                                 Eigen::Vector3d::Zero(),
                                 [&](scene::SceneDescription& d) {
                                   d.config.haptics.tip_radius_m = 0.0;
                                   d.config.cues = cues;
                                   d.config.parts.push_back({"middle", "", {0.04, -1.0, 0.06, 1.0}});
                                 });
}

HapticWindow window_of(const scene::ScenePointer& scene, double scale = 1.0) {
  WindowPlan plan = plan_window(scene->description(), 0, {0.05, 0.05}, kWidth_m * scale);
  return load_window(*scene, plan, 1);
}

/// What the motors were told along one way over the stone: down, to the right across all of it, beyond its rim.
struct Told {
  std::vector<Eigen::Vector3d> force_n;
  std::array<std::uint64_t, scene::kCues> counts{};
  std::array<std::vector<std::size_t>, scene::kCues> ticks;  // when
};

Told travel(const std::optional<scene::CuesConfig>& cues, bool zoom = false) {
  const scene::ScenePointer scene = stone(cues);
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, window_of(scene));
  Told told;
  const auto go = [&](double x_m, double z_m) {
    const double time_s = 0.001 * static_cast<double>(told.force_n.size());
    renderer.update(sample_at({x_m - 0.05, 0.0, z_m}, time_s), 0.001);
    const State& state = renderer.state();
    for (std::size_t cue = 0; cue < scene::kCues; ++cue)
      if (state.cues[cue] > told.counts[cue]) told.ticks[cue].push_back(told.force_n.size());
    told.counts = state.cues;
    const auto& f = state.commanded_force_n;
    told.force_n.emplace_back(f[0], f[1], f[2]);
  };
  for (int k = 0; k < 200; ++k) go(0.02, 0.01);
  for (int k = 0; k < 200; ++k) go(0.02, 0.01 - 0.011 * k / 200.0);
  for (int k = 0; k < 900; ++k) go(0.02 + 0.0001 * k, -0.001);
  if (zoom) {
    for (int k = 0; k < 200; ++k) go(0.05, 0.01);
    Command swap;
    swap.kind = Command::Kind::swap;
    swap.window = window_of(scene, 2.0);
    static_cast<void>(renderer.apply(swap));
    for (int k = 0; k < 200; ++k) go(0.05, 0.01);
  }
  return told;
}

double most(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b, std::size_t from,
            std::size_t to) {
  double result = 0.0;
  for (std::size_t k = from; k < std::min({to, a.size(), b.size()}); ++k)
    result = std::max(result, (a[k] - b[k]).norm());
  return result;
}

TEST(Cues, EachIsToldOnceWhereTheHandComesToIt) {
  const Told told = travel(scene::CuesConfig{}, true);
  EXPECT_EQ(told.counts, (std::array<std::uint64_t, scene::kCues>{1, 1, 1, 1, 1}));
  // x = 20 mm at tick 400, 0.1 mm per tick; what is known of a place is known one tick later.
  const auto at = [&](Cue cue) { return static_cast<double>(told.ticks[static_cast<std::size_t>(cue)].front()); };
  EXPECT_NEAR(at(Cue::part_entered), 600.0, 3.0);
  EXPECT_NEAR(at(Cue::part_left), 820.0, 3.0) << "2 mm away: nothing is told of a border again and again";
  EXPECT_NEAR(at(Cue::unmeasured), 1000.0, 8.0) << "the cell between the last node that is known and the next";
  EXPECT_NEAR(at(Cue::edge), 1200.0, 8.0);
  EXPECT_EQ(at(Cue::level), 1500.0);
}

TEST(Cues, TickLightlyAndShortly) {
  const Told with = travel(scene::CuesConfig{}, true);
  const Told without = travel(std::nullopt, true);
  for (std::size_t cue = 0; cue < scene::kCues; ++cue) {
    const std::size_t at = with.ticks[cue].front();
    const double felt_n = most(with.force_n, without.force_n, at, at + 45);
    EXPECT_LE(felt_n, Cues::kTick_n + 1e-9) << cue;
    EXPECT_GE(felt_n, 0.1) << cue << ": it is felt";
    EXPECT_EQ(most(with.force_n, without.force_n, at - 20, at), 0.0) << cue;
    EXPECT_LE(most(with.force_n, without.force_n, at + 45, at + 100), 1e-12) << cue;
    for (std::size_t k = at; k < at + 45; ++k) {
      if (without.force_n[k].z() > 0.0) {
        EXPECT_GE(with.force_n[k].z(), 0.0) << "the stone never pulls";
      }
    }
  }
}

TEST(Cues, AreTurnedOffOneByOne) {
  const Told none = travel(std::nullopt, true);
  const Told all = travel(scene::CuesConfig{}, true);
  for (std::size_t off = 0; off < scene::kCues; ++off) {
    scene::CuesConfig config;
    config.tick[off] = false;
    const Told told = travel(config, true);
    EXPECT_EQ(told.counts, all.counts) << "sounds are made of them all the same";
    for (std::size_t cue = 0; cue < scene::kCues; ++cue) {
      const std::size_t at = told.ticks[cue].front();
      if (cue == off) {
        EXPECT_EQ(most(told.force_n, none.force_n, at, at + 45), 0.0) << off;
      } else {
        EXPECT_GT(most(told.force_n, none.force_n, at, at + 45), 0.1) << off << " " << cue;
      }
    }
  }
  EXPECT_EQ(none.counts, (std::array<std::uint64_t, scene::kCues>{}));
}

TEST(Cues, AreNotRepeatedByAHandThatTremblesOnABorder) {
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, window_of(stone(scene::CuesConfig{})));
  for (int k = 0; k < 800; ++k) {
    const double z_m = k < 300 ? 0.01 : -0.001;
    renderer.update(sample_at({0.0301 + 0.0004 * (k / 5 % 2), 0.0, z_m}, 0.001 * k), 0.001);
  }
  EXPECT_LE(renderer.state().cues[static_cast<std::size_t>(Cue::unmeasured)], 1U);
}

TEST(Cues, AHandThatCirclesOverTheBordersOfPartsInPartsIsToldRarely) {
  const scene::ScenePointer scene =
      sparsha::test::scene_of([](double, double) { return 0.0; }, 201, kWidth_m, 201, Eigen::Vector3d::Zero(),
                              [](scene::SceneDescription& d) {
                                d.config.cues = scene::CuesConfig{};
                                d.config.parts.push_back({"eye", "", {0.045, 0.05, 0.055, 0.06}});
                                d.config.parts.push_back({"head", "", {0.035, 0.04, 0.065, 0.07}});
                              });
  // 29 s: at every border it would be 20 to 130.
  for (const double period_s : {1.0, 2.0, 4.0})
    for (const double radius_m : {0.007, 0.012, 0.016}) {
      HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, window_of(scene));
      for (int k = 0; k < 29300; ++k) {
        const double angle = 2.0 * std::numbers::pi * 0.001 * k / period_s;
        const double z_m = k < 300 ? 0.01 : -0.001;
        renderer.update(sample_at({radius_m * std::cos(angle), 0.001 + radius_m * std::sin(angle), z_m}, 0.001 * k),
                        0.001);
      }
      const auto& cues = renderer.state().cues;
      const std::uint64_t told = cues[static_cast<std::size_t>(Cue::part_entered)];
      const std::uint64_t left = cues[static_cast<std::size_t>(Cue::part_left)];
      EXPECT_GE(told, 1U) << period_s << " s, " << radius_m << " m";
      EXPECT_LE(told, 10U) << period_s << " s, " << radius_m << " m";
      EXPECT_LE(left, 10U) << period_s << " s, " << radius_m << " m";
      std::printf("%.0f s, %.0f mm: %d entered, %d left\n", period_s, 1e3 * radius_m, static_cast<int>(told),
                  static_cast<int>(left));
    }
}

TEST(Cues, TheDistanceFromTheStoneIsThatOfTheNearestKnownNodeAndOfTheHeight) {
  HapticRenderer renderer(DeviceInfo{}, RendererOptions{}, window_of(stone(scene::CuesConfig{})));
  const auto away_m = [&](double x_m, double z_m) {
    static double time_s = 0.0;
    renderer.update(sample_at({x_m - 0.05, 0.0, z_m}, time_s += 0.001), 0.001);
    return renderer.state().away_m;
  };
  EXPECT_NEAR(away_m(0.02, 0.03), 0.03, 1e-6);
  EXPECT_NEAR(away_m(0.095, 0.0), 0.015, 0.001);
  EXPECT_NEAR(away_m(0.12, 0.03), std::hypot(0.04, 0.03), 0.001) << "beyond the window";
  EXPECT_EQ(away_m(0.02, -0.001), 0.0);
}

TEST(Cues, DistancesOnALatticeAreAtMostEightPercentTooFar) {
  scene::DepthGrid grid(scene::Lattice{60, 50, 0.002, Eigen::Vector3d::Zero()});
  const std::vector<std::array<int, 2>> known = {{3, 4}, {40, 20}, {10, 45}};
  for (const auto& [i, j] : known) grid.state[grid.lattice.index(i, j)] = scene::NodeState::measured;
  const std::vector<float> found = distance_to_stone(grid);
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 60; ++i) {
      double least = HUGE_VAL;
      for (const auto& [ki, kj] : known) least = std::min(least, 0.002 * std::hypot(i - ki, j - kj));
      const auto told = static_cast<double>(found[grid.lattice.index(i, j)]);
      ASSERT_GE(told, least - 1e-6);
      ASSERT_LE(told, 1.083 * least + 1e-6);
    }
}

}  // namespace
}  // namespace sparsha::haptics
