// A stroke whose press and speed change: its sound follows them without the steps in which they come.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/audio/listening.h"
#include "tests/audio/stroking.h"

namespace {

using namespace sparsha;
using namespace stroking;
using listening::Samples;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// What a tone of a grating, and of its overtones, leaves between its lines, relative to all of it.
double between_lines_db(const Samples& sound, double line_hz, double beside_hz) {
  const auto power =
      listening::spectrum(sound, static_cast<std::size_t>(0.2 * kRate), static_cast<std::size_t>(1.1 * kRate));
  const double bin = kRate / (2.0 * static_cast<double>(power.size()));
  double all = 0.0, between = 0.0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const double frequency_hz = static_cast<double>(k) * bin;
    const double off_hz = std::abs(frequency_hz - line_hz * std::max(1.0, std::round(frequency_hz / line_hz)));
    all += power[k] * power[k];
    if (frequency_hz > 100.0 && off_hz > beside_hz) between += power[k] * power[k];
  }
  return 10.0 * std::log10(between / all);
}

/// What lies between two frequencies, relative to all of it.
double band_db(const Samples& sound, double from_hz, double to_hz) {
  const auto power =
      listening::spectrum(sound, static_cast<std::size_t>(0.2 * kRate), static_cast<std::size_t>(1.1 * kRate));
  const double bin = kRate / (2.0 * static_cast<double>(power.size()));
  double all = 0.0, band = 0.0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const double frequency_hz = static_cast<double>(k) * bin;
    all += power[k] * power[k];
    if (frequency_hz > from_hz && frequency_hz < to_hz) band += power[k] * power[k];
  }
  return 10.0 * std::log10(band / all);
}

scene::ScenePointer grating(const test::SceneOptions& options, double wave_m) {
  return stone([wave_m](double x, double) { return 3e-5 * std::sin(kTurn * x / wave_m); }, options, std::nullopt, 0.5,
               false);
}

/// Every `every` milliseconds one state, as a sound card sees them; 0: between 1 and 12, at random.
std::vector<haptics::State> seen(const std::vector<haptics::State>& states, int every) {
  std::vector<haptics::State> result;
  std::mt19937 random(7);
  int skip = 0;
  for (const haptics::State& state : states) {
    if (skip-- > 0) continue;
    result.push_back(state);
    skip = every > 0 ? every - 1 : static_cast<int>(random() % 12);
  }
  return result;
}

TEST(Zipper, APressThatSwellsAndFallsIsNotHeardInSteps) {
  const test::SceneOptions options{6000, 8, 0.00005};
  const auto scene = grating(options, 0.0005);
  auto steady = stroke(0.2, 1.2, options, 2.0);
  auto swelling = steady;
  for (haptics::State& state : swelling) state.force_n[2] = 2.0 + 1.5 * std::sin(kTurn * 4.0 * state.time_s);
  for (const int every : {1, 3, 10, 0}) {
    const double floor_db = between_lines_db(hear(scene, seen(steady, every)), 400.0, 40.0);
    const double heard_db = between_lines_db(hear(scene, seen(swelling, every)), 400.0, 40.0);
    std::printf("states every %d ms: %.1f dB steady, %.1f dB swelling\n", every, floor_db, heard_db);
    EXPECT_LT(heard_db, -60.0) << every;
  }
}

TEST(Zipper, ASpeedThatChangesMakesNoCorners) {
  // Waves of 1 mm at 0.1 to 0.3 m/s sound at 100 to 300 Hz, the nodes pass at 5 to 15 kHz: between them is nothing.
  const test::SceneOptions options{13000, 8, 0.00002};
  const auto scene = grating(options, 0.001);
  std::vector<haptics::State> states;
  for (double t = 0.0; t < 1.2; t += 1e-3) {
    const double x = 0.002 + 0.2 * t + 0.1 / (kTurn * 2.0) * (1.0 - std::cos(kTurn * 2.0 * t));
    states.push_back(hand(t, x, 3.5 * options.spacing_m, options, 1.0 + 0.8 * std::sin(kTurn * 3.0 * t)));
  }
  for (const int every : {1, 3, 10, 0}) {
    const double heard_db = band_db(hear(scene, seen(states, every)), 1500.0, 4500.0);
    std::printf("states every %d ms: %.1f dB between 1.5 and 4.5 kHz\n", every, heard_db);
    EXPECT_LT(heard_db, -55.0) << every;
  }
}

TEST(Zipper, AHandThatLandsAndLiftsFadesInAndOut) {
  const test::SceneOptions options{13000, 8, 0.00002};
  const auto scene = grating(options, 0.001);
  auto states = stroke(0.2, 1.2, options, 3.0);
  for (haptics::State& state : states) {
    const bool off = std::fmod(state.time_s, 0.3) > 0.2;
    state.contact = off ? 0 : 1;
    if (off) state.force_n[2] = 0.0;
  }
  const double heard_db = band_db(hear(scene, states), 1500.0, 8000.0);
  std::printf("landing and lifting: %.1f dB between 1.5 and 8 kHz\n", heard_db);
  EXPECT_LT(heard_db, -50.0);
}

}  // namespace
