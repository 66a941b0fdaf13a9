// The sound of a stroke: pitch, silence, roughness, loudness beside a strike.
#include "audio/scrape/needle.h"

#include <gtest/gtest.h>

#include <random>

#include "audio/synth.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"
#include "tests/audio/stroking.h"
#include "tests/support/servo_parts.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;
using namespace stroking;

constexpr double kTurn = 2.0 * std::numbers::pi;

double strongest(const listening::Samples& sound, double from_s, double to_s, double below_hz) {
  return listening::strongest_frequency(sound, 12.0, below_hz, kRate, static_cast<std::size_t>(from_s * kRate),
                                        static_cast<std::size_t>(to_s * kRate));
}

/// Centre of gravity of the power spectrum up to 12 kHz.
double centroid_hz(const listening::Samples& sound) {
  const auto line = listening::spectrum(sound, 0, sound.size());
  const double bin = kRate / (2.0 * static_cast<double>(line.size()));
  double power = 0.0, moment = 0.0;
  for (std::size_t k = 0; static_cast<double>(k) * bin < 12000.0; ++k) {
    power += line[k] * line[k];
    moment += static_cast<double>(k) * bin * line[k] * line[k];
  }
  return moment / power;
}

/// Loudest 50 ms.
double loudest_rms(const listening::Samples& sound) {
  double most = 0.0;
  for (std::size_t begin = 0; begin + 2400 <= sound.size(); begin += 240)
    most = std::max(most, listening::rms(sound, begin, begin + 2400));
  return most;
}

/// Waves of random heading whose amplitudes fall as wavelength^power, so steep as `slope` says.
Height random_stone(double shortest_m, double power, double slope, unsigned seed) {
  struct Wave {
    double x, y, phase, height;
  };
  std::vector<Wave> waves;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double steep = 0.0;
  for (int k = 0; k < 120; ++k) {
    const double length = shortest_m * std::pow(0.02 / shortest_m, unit(random));
    const double heading = kTurn * unit(random);
    const double height = std::pow(length, power);
    waves.push_back(
        {kTurn / length * std::cos(heading), kTurn / length * std::sin(heading), kTurn * unit(random), height});
    steep += 0.25 * std::pow(kTurn / length * height, 2);
  }
  const double share = slope / std::sqrt(steep);
  return [waves, share](double x, double y) {
    double z = 0.0;
    for (const Wave& wave : waves) z += wave.height * std::sin(wave.x * x + wave.y * y + wave.phase);
    return share * z;
  };
}

TEST(Needle, AGratingSoundsAtSpeedOverWavelengthWithinOnePercentFrom10To500MillimetresPerSecond) {
  for (const double wavelength : {0.0005, 0.0013}) {
    const test::SceneOptions options{6000, 8, 0.00005};
    const auto scene = stone([&](double x, double) { return 3e-5 * std::sin(kTurn * x / wavelength); }, options);
    for (const double speed : {0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5}) {
      const double expected = speed / wavelength;
      if (expected < 15.0) continue;
      const double seconds = speed > 0.3 ? 0.55 : 1.0;
      const auto sound = hear(scene, stroke(speed, seconds, options));
      const double heard = strongest(sound, 0.15, seconds - 0.02, 12000.0);
      EXPECT_NEAR(heard / expected, 1.0, 0.01) << speed << " m/s over " << wavelength;
    }
  }
}

TEST(Needle, StatesThatAreSeenLateAndSeldomLeaveThePitchAsItIs) {
  const test::SceneOptions options{4000, 8, 0.00005};
  const auto scene = stone([](double x, double) { return 3e-5 * std::sin(kTurn * x / 0.0005); }, options);
  std::mt19937 random(5);
  std::vector<haptics::State> seen;
  int skip = 0;
  for (const haptics::State& state : stroke(0.15, 1.0, options)) {
    if (skip-- > 0) continue;
    seen.push_back(state);
    skip = static_cast<int>(random() % 8);
  }
  EXPECT_NEAR(strongest(hear(scene, seen), 0.15, 0.95, 12000.0) / 300.0, 1.0, 0.01);
}

TEST(Needle, AGratingFeltThroughTheServoSoundsAtSpeedOverWavelength) {
  const double wavelength = 0.001;
  const test::SceneOptions options{1200, 40, 0.0001};
  const auto scene = stone([&](double x, double) { return 1e-5 * std::sin(kTurn * x / wavelength); }, options);
  for (const double speed : {0.05, 0.15}) {
    haptics::DeviceInfo info;
    info.name = "scripted";
    haptics::WindowPlan plan;
    plan.nx = options.nx;
    plan.ny = options.ny;
    plan.scale = 1.0;
    haptics::HapticRenderer renderer(info, {}, haptics::load_window(*scene, plan, 1));
    std::vector<haptics::State> states;
    for (int i = 0; i < 700; ++i) {
      const double t = i * 1e-3;
      const double z = std::max(-0.001, 0.01 - 0.1 * t);
      const double x = -0.055 + speed * std::max(0.0, t - 0.12);
      renderer.update(haptics::sample_at({x, 0.0, z}, t), 1e-3);
      states.push_back(renderer.state());
    }
    const auto sound = hear(scene, states);
    EXPECT_NEAR(strongest(sound, 0.25, 0.68, 12000.0) * wavelength / speed, 1.0, 0.01) << speed;
  }
}

TEST(Needle, IsExactlySilentAtRestAlsoUnderAnEncoderThatFlickers) {
  const test::SceneOptions options{400, 400, 0.0001};
  const auto scene = stone(random_stone(0.0004, 1.0, 0.3, 1), options);
  std::mt19937 random(3);
  std::vector<haptics::State> states;
  for (double t = 0.0; t < 1.0; t += 1e-3) {
    const auto step = [&] { return 58e-6 * static_cast<double>(random() % 2); };
    states.push_back(hand(t, 0.02 + step(), 0.02 + step(), options));
  }
  for (const double value : hear(scene, states)) ASSERT_EQ(value, 0.0);
}

TEST(Needle, StopsToExactZerosWithinAQuarterOfASecond) {
  const test::SceneOptions options{2000, 40, 0.0001};
  const auto scene = stone(random_stone(0.0004, 1.0, 0.3, 1), options);
  for (const bool lifted : {false, true}) {
    auto states = stroke(0.1, 0.5, options);
    haptics::State last = states.back();
    for (double t = 0.5; t < 0.8; t += 1e-3) {
      last.time_s = t;
      last.contact = lifted ? 0 : 1;
      states.push_back(last);
    }
    const auto sound = hear(scene, states, 0.1);
    EXPECT_GT(listening::rms(sound, 12000, 24000), 1e-4);
    for (std::size_t i = 36000; i < sound.size(); ++i) ASSERT_EQ(sound[i], 0.0) << i << lifted;
  }
}

TEST(Needle, ALevelPlaneIsMute) {
  const test::SceneOptions options{400, 40, 0.0005};
  for (const double value : hear(stone([](double, double) { return 0.0; }, options), stroke(0.1, 0.8, options)))
    ASSERT_EQ(value, 0.0);
}

TEST(Needle, RoughStoneIsLouderAndBrighterThanSmoothStone) {
  const test::SceneOptions options{1500, 60, 0.0001};
  const auto rough = hear(stone(random_stone(0.0004, 0.9, 0.15, 2), options), stroke(0.1, 1.2, options));
  const auto smooth = hear(stone(random_stone(0.002, 1.6, 0.03, 2), options), stroke(0.1, 1.2, options));
  EXPECT_GT(listening::decibel(listening::rms(rough, 9600, 52800) / listening::rms(smooth, 9600, 52800)), 6.0);
  EXPECT_GT(centroid_hz(rough), 1.3 * centroid_hz(smooth));
}

TEST(Needle, FasterAndHarderStrokesAreLouder) {
  const test::SceneOptions options{4000, 60, 0.0001};
  const auto scene = stone(random_stone(0.0004, 1.0, 0.05, 4), options);
  const auto level = [&](double speed, double press) {
    return listening::decibel(loudest_rms(hear(scene, stroke(speed, 0.8, options, press))));
  };
  EXPECT_GT(level(0.1, 1.0), level(0.03, 1.0) + 2.0);
  EXPECT_GT(level(0.3, 1.0), level(0.1, 1.0) + 2.0);
  EXPECT_NEAR(level(0.1, 2.0) - level(0.1, 1.0), 20.0 * std::log10(2.0), 0.1);
}

TEST(Needle, AStrikeIsSixDecibelsLouderThanTheRoughestStrokeOfTheSameForceOnEveryMaterial) {
  const test::SceneOptions options{3000, 60, 0.0001};
  for (std::size_t m = 0; m < scene::kMaterials.size(); ++m) {
    const auto material = static_cast<scene::Material>(m);
    const auto scene = stone(random_stone(0.0006, 1.0, 1.5, 6), options, material, 1.0);
    for (const double force : {0.3, 1.0, 3.0}) {
      Synth synth(make_sound_bank(*scene, 48000));
      ASSERT_TRUE(synth.contact(audio_scene::touch(0.0, 0.01, 0.002, force), 0));
      const double struck = loudest_rms(listening::channel(audio_scene::render(synth, 0.5), 0));
      const double stroked = loudest_rms(hear(scene, stroke(0.25, 0.9, options, force)));
      EXPECT_GE(listening::decibel(struck / stroked), 6.0) << scene::kMaterials[m].name << " " << force << " N";
    }
  }
}

TEST(Needle, SoundsEquallyLoudAtEverySampleRate) {
  const test::SceneOptions options{1500, 60, 0.0001};
  const auto scene = stone(random_stone(0.0005, 1.0, 0.1, 8), options);
  const auto level = [&](int rate) {
    Synth synth(make_sound_bank(*scene, rate));
    ProfileReader reader(scene, false);
    std::shared_ptr<const Profile> profile;
    for (const haptics::State& state : stroke(0.1, 0.9, options)) {
      if (auto next = reader.update(state)) synth.profile(profile = next, 0);
      synth.state(state, static_cast<std::uint64_t>(std::llround(state.time_s * rate)));
    }
    const auto sound = listening::channel(audio_scene::render(synth, 0.9), 0);
    return listening::decibel(
        listening::rms(sound, static_cast<std::size_t>(0.2 * rate), static_cast<std::size_t>(0.88 * rate)));
  };
  const double reference = level(48000);
  EXPECT_NEAR(level(44100), reference, 0.2);
  EXPECT_NEAR(level(96000), reference, 0.2);
}

TEST(Needle, FarFromTheOriginOfItsNumbersItSoundsTheSame) {
  const Height waves = random_stone(0.001, 1.0, 0.1, 9);
  test::SceneOptions near{1000, 60, 0.0001};
  test::SceneOptions far = near;
  far.origin_m = {450000.0, 5412000.0, 120.0};
  const auto states = stroke(0.08, 0.9, near);
  auto moved = states;
  for (haptics::State& state : moved)
    for (std::size_t axis = 0; axis < 3; ++axis) state.proxy_m[axis] += far.origin_m[static_cast<int>(axis)];
  // Without grain, which is another one at another place.
  const auto here = hear(stone(waves, near, std::nullopt, 0.5, false), states);
  const auto there = hear(stone(waves, far, std::nullopt, 0.5, false), moved);
  listening::Samples difference(here.size());
  for (std::size_t i = 0; i < here.size(); ++i) difference[i] = here[i] - there[i];
  EXPECT_LT(listening::decibel(listening::rms(difference, 9600, 40000) / listening::rms(here, 9600, 40000)), -40.0);
}

TEST(Profile, IsTheSurfaceThatTheForceComesFrom) {
  // A point that slides over waves of 8 mm on nodes 0.25 mm apart: what smooths creases and what runs through the nodes
  // differ by h^2 / 6 times the curvature.
  const double amplitude = 2e-4, wave = 0.008, spacing = 0.00025;
  const test::SceneOptions options{300, 80, spacing};
  const auto scene = stone([&](double x, double) { return amplitude * std::sin(kTurn * x / wave); }, options);
  haptics::WindowPlan plan;
  plan.nx = options.nx;
  plan.ny = options.ny;
  haptics::DeviceInfo info;
  info.name = "scripted";
  haptics::HapticRenderer renderer(info, {}, haptics::load_window(*scene, plan, 1));
  const ViewProfile profile(*scene, {0, 0, 0, options.nx, options.ny, true}, nullptr);
  const double curvature = amplitude * kTurn * kTurn / (wave * wave);
  int touched = 0;
  for (int i = 0; i < 900; ++i) {
    const double t = i * 1e-3;
    renderer.update(haptics::sample_at({-0.03 + 0.05 * t, 0.0, std::max(-0.002, 0.01 - 0.1 * t)}, t), 1e-3);
    const haptics::State& state = renderer.state();
    if (state.contact == 0) continue;
    ++touched;
    EXPECT_NEAR(profile.height_m(0, {state.proxy_m[0], state.proxy_m[1], 0.0}), state.proxy_m[2],
                spacing * spacing / 6.0 * curvature + 1e-8);
  }
  EXPECT_GT(touched, 700);
}

TEST(Profile, ReadsTheFinestLevelThatTheWindowLeavesRoomFor) {
  const auto scene = test::scene_of([](double, double) { return 0.0; }, {3000, 3000, 0.001, 4});
  haptics::State state;
  state.level = 3;
  state.window = {10, 20, 200, 150};
  const ViewProfile::Window window = ViewProfile::window_of(scene->description(), state);
  EXPECT_EQ(window.level, 1);
  EXPECT_EQ(window.i0, 40);
  EXPECT_EQ(window.j0, 80);
  EXPECT_EQ(window.nx, 797);
  EXPECT_EQ(window.ny, 597);
}

}  // namespace
