// Strokes on whole objects sound on all of their sides; judged by the formulas of the stones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "audio/scrape/object_profile.h"
#include "audio/scrape/profile.h"
#include "audio/sound_bank.h"
#include "scene/charts.h"
#include "scene/material/grain_field.h"
#include "tests/audio/listening.h"
#include "tests/audio/stroking.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::audio {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSpacing_m = 0.00025, kWave_m = 0.0016, kHigh_m = 0.00004;
constexpr double kSpeed = 0.1;  // m/s, along the surface
constexpr int kHalf = 200;      // nodes from a block's middle to its faces

scene::ScenePointer sounding(scene::Charts charts) {
  return test::whole_scene(std::move(charts), 0.2, [](scene::SceneDescription& d) {
    d.config.around = scene::AroundConfig{};
    d.config.audio = scene::AudioConfig{};
    d.config.audio->friction_sound_gain = 0.5;
    d.config.audio->friction_sound_grain = false;
  });
}

/// A block whose six faces have waves along their u.
scene::Charts waved_block() {
  return test::charts_of(
      [](scene::Side, double u, double) {
        return test::SeenSurface{kHalf * kSpacing_m + kHigh_m * std::sin(kTurn * u / kWave_m), 0.0, 0.0};
      },
      kHalf, kSpacing_m);
}

/// A hand that goes over places of the grid frame.
std::vector<haptics::State> stroke(const std::function<Vector3d(double time_s)>& at, double seconds,
                                   std::uint64_t flags = haptics::kFlagAround | haptics::kFlagTexture) {
  std::vector<haptics::State> states;
  for (double t = 0.0; t < seconds; t += 1e-3) {
    const Vector3d place_m = at(t);
    haptics::State state = stroking::hand(t, place_m.x(), place_m.y(), {401, 401, kSpacing_m});
    state.proxy_m = state.place_m = {place_m.x(), place_m.y(), place_m.z()};
    state.flags = haptics::kFlagArmed | flags;
    states.push_back(state);
  }
  return states;
}

double level_db(const scene::ScenePointer& scene, const std::vector<haptics::State>& states) {
  const auto sound = stroking::hear(scene, states);
  return listening::decibel(listening::rms(sound, 9600, sound.size() - 4800) + 1e-12);
}

TEST(ObjectProfile, StrokesSoundAlikeOnAllSides) {
  const auto scene = sounding(waved_block());
  std::vector<double> levels;
  for (std::size_t k = 0; k < scene::kSides; ++k) {
    const scene::SideAxes axes = scene::SideAxes::of(static_cast<scene::Side>(k));
    const auto along = [&](bool u) {
      return [&axes, u](double t) {
        const double way_m = -0.035 + kSpeed * t;
        return axes.to_grid(Vector3d(u ? way_m : 0.0004, u ? 0.0004 : way_m, kHalf * kSpacing_m));
      };
    };
    levels.push_back(level_db(scene, stroke(along(true), 0.7)));
    EXPECT_LT(level_db(scene, stroke(along(false), 0.7)), levels.back() - 40.0) << "along the waves' crests";
  }
  for (const double level : levels) EXPECT_NEAR(level, levels.front(), 0.3);
  EXPECT_GT(levels.front(), -60.0);
  // The same waves on one view.
  const test::SceneOptions options{401, 401, kSpacing_m};
  const auto view = stroking::stone([](double x, double) { return kHigh_m * std::sin(kTurn * x / kWave_m); }, options,
                                    std::nullopt, 0.5, false);
  EXPECT_NEAR(level_db(view, stroking::stroke(kSpeed, 0.7, options)), levels.front(), 0.3);
}

TEST(ObjectProfile, AStoneThatLeansSoundsAsOneThatDoesNot) {
  const auto leaning = [](double angle) {
    const double cosine = std::cos(angle), slope = std::tan(angle);
    auto charts = test::charts_of(
        [&](scene::Side side, double u, double) -> std::optional<test::SeenSurface> {
          if (side != scene::Side::front) return std::nullopt;
          return test::SeenSurface{-u * slope + kHigh_m * std::sin(kTurn * u / (cosine * kWave_m)) / cosine, -slope,
                                   0.0};
        },
        kHalf, kSpacing_m);
    const auto scene = sounding(std::move(charts));
    return level_db(scene, stroke(
                               [&](double t) {
                                 const double u = cosine * (-0.035 + kSpeed * t);
                                 return Vector3d(u, 0.0, -u * slope);
                               },
                               0.7));
  };
  for (const double angle : {0.4, -0.8}) EXPECT_NEAR(leaning(angle), leaning(0.0), 0.7) << angle;
}

TEST(ObjectProfile, SmoothObjectsAreQuietAlsoWhereSidesMeet) {
  const double radius_m = 0.04;
  const auto ball = sounding(test::ball_charts(radius_m, 0.0005));
  const auto round = [&](const Vector3d& from, const Vector3d& to) {
    return stroke(
        [=](double t) {
          const double angle = kSpeed * t / radius_m;
          return Vector3d(radius_m * (std::cos(angle) * from + std::sin(angle) * to));
        },
        2.4);
  };
  const double loud =
      level_db(sounding(waved_block()),
               stroke([](double t) { return Vector3d(-0.035 + kSpeed * t, 0.0004, kHalf * kSpacing_m); }, 0.7));
  EXPECT_LT(level_db(ball, round(Vector3d::UnitZ(), Vector3d::UnitX())), loud - 30.0);
  EXPECT_LT(level_db(ball, round(Vector3d::UnitZ(), Vector3d(1.0, 1.0, 0.0).normalized())), loud - 30.0);
  EXPECT_LT(level_db(ball, round(Vector3d(1.0, -1.0, 0.3).normalized(), Vector3d(0.3, 0.3, 0.0).normalized())),
            loud - 30.0);
}

TEST(ObjectProfile, WithoutTextureTheEnvelopeIsHeard) {
  scene::Charts charts = waved_block();
  for (scene::Sheet& sheet : charts.sheets) {
    sheet.texture_m.resize(sheet.count());
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = 0; i < sheet.nx; ++i)
        sheet.texture_m[sheet.index(i, j)] =
            static_cast<float>(kHigh_m * std::sin(kTurn * (sheet.first_u + i) * kSpacing_m / kWave_m));
  }
  const auto scene = sounding(std::move(charts));
  const auto along = [](double t) { return Vector3d(kHalf * kSpacing_m, -0.035 + kSpeed * t, 0.0); };
  EXPECT_LT(level_db(scene, stroke(along, 0.7, haptics::kFlagAround)), level_db(scene, stroke(along, 0.7)) - 40.0);
}

TEST(ObjectProfile, AStrokeIntoAHoleAndOutOfItIsNoClick) {
  scene::Charts charts = waved_block();
  const auto whole = sounding(charts);
  for (scene::Sheet& sheet : charts.sheets)
    for (int j = 0; j < sheet.ny; ++j)
      for (int i = kHalf - 20; i <= kHalf + 20; ++i) {
        sheet.mask[sheet.index(i, j)] = 0;
        sheet.height_m[sheet.index(i, j)] = sheet.slope_u[sheet.index(i, j)] = sheet.slope_v[sheet.index(i, j)] =
            std::nanf("");
      }
  const auto holed = sounding(std::move(charts));
  const auto along = [](double t) { return Vector3d(-0.035 + kSpeed * t, 0.0004, kHalf * kSpacing_m); };
  const auto loudest = [&](const scene::ScenePointer& scene) {
    const auto sound = stroking::hear(scene, stroke(along, 0.7));
    double most = 0.0;
    for (const double value : sound) {
      EXPECT_TRUE(std::isfinite(value));
      most = std::max(most, std::abs(value));
    }
    return most;
  };
  EXPECT_LT(loudest(holed), 1.5 * loudest(whole));
}

TEST(GrainOnSurfaces, IsAsStrongHoweverTheSurfaceLies) {
  const scene::GrainField field(scene::HeightSpectrum{4e-14, 2.0, 800.0});
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-0.2, 0.2);
  for (const Vector3d& normal :
       {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0.577, 0.577, -0.577), Vector3d(0.8, -0.6, 0)}) {
    const Vector3d shares = scene::GrainField::shares(normal);
    for (const int band : {0, 7}) {
      double sum = 0.0;
      constexpr int kPlaces = 20000;
      for (int k = 0; k < kPlaces; ++k)
        sum += std::pow(field.height_m(band, Vector3d(place(random), place(random), place(random)), shares), 2);
      EXPECT_NEAR(std::sqrt(sum / kPlaces), field.deviation_m(band), 0.05 * field.deviation_m(band));
    }
  }
  for (int k = 0; k < 100; ++k) {
    const double x = place(random), y = place(random);
    EXPECT_EQ(field.height_m(3, Vector3d(x, y, place(random)), scene::GrainField::shares(Vector3d::UnitZ())),
              field.height_m(3, x, y));
  }
}

}  // namespace
}  // namespace sparsha::audio
