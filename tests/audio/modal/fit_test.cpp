// Modes of recorded strikes against strikes made with known ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>

#include "audio/clip/clip.h"
#include "audio/modal/fit.h"
#include "audio/synth.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

constexpr double kRate = 48000.0;

/// Decaying sinusoids after 50 ms of silence, with a floor of noise 70 dB below the first.
std::vector<float> recording(const std::vector<scene::ModeConfig>& modes, double seconds, double noise = 3e-4) {
  std::mt19937 random(11);
  std::normal_distribution<double> floor(0.0, noise);
  std::vector<float> sound(static_cast<std::size_t>(seconds * kRate));
  for (std::size_t i = 0; i < sound.size(); ++i) {
    const double t = static_cast<double>(i) / kRate - 0.05;
    double value = floor(random);
    for (std::size_t k = 0; k < modes.size() && t >= 0.0; ++k)
      value += 0.3 * std::pow(10.0, modes[k].level_db / 20.0) * std::exp(-6.907755 * t / modes[k].decay_s) *
               std::sin(2.0 * std::numbers::pi * modes[k].frequency_hz * t + 0.7 * static_cast<double>(k));
    sound[i] = static_cast<float>(value);
  }
  return sound;
}

void expect_modes(const std::vector<scene::ModeConfig>& truth, const std::vector<scene::ModeConfig>& found) {
  for (const scene::ModeConfig& mode : truth) {
    const scene::ModeConfig* nearest = nullptr;
    for (const scene::ModeConfig& other : found)
      if (nearest == nullptr ||
          std::abs(other.frequency_hz - mode.frequency_hz) < std::abs(nearest->frequency_hz - mode.frequency_hz))
        nearest = &other;
    ASSERT_NE(nearest, nullptr) << mode.frequency_hz;
    EXPECT_LT(std::abs(1200.0 * std::log2(nearest->frequency_hz / mode.frequency_hz)), 2.0) << mode.frequency_hz;
    EXPECT_NEAR(nearest->decay_s / mode.decay_s, 1.0, 0.05) << mode.frequency_hz;
    EXPECT_NEAR(nearest->level_db, mode.level_db, 1.0) << mode.frequency_hz;
  }
}

TEST(Fit, FindsTheModesOfAPillarWithin2CentsAnd5PercentOfItsDecays) {
  const std::vector<scene::ModeConfig> truth = {
      {240.0, 1.2, 0.0}, {630.3, 0.46, -4.0}, {1170.9, 0.25, -9.0}, {1820.4, 0.16, -12.0}, {2550.0, 0.115, -16.0}};
  const auto found = fit_modes(recording(truth, 2.0), kRate);
  expect_modes(truth, found);
  EXPECT_LE(found.size(), truth.size() + 2) << "and hardly any that are not there";
}

TEST(Fit, FindsModesAtRandom) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<scene::ModeConfig> truth;
    double frequency = 90.0 + 200.0 * unit(random);
    for (int k = 0; k < 6; ++k) {
      truth.push_back({frequency, 0.3 + 1.2 * unit(random), k == 0 ? 0.0 : -15.0 * unit(random)});
      frequency *= 1.25 + 0.7 * unit(random);
    }
    SCOPED_TRACE(seed);
    expect_modes(truth, fit_modes(recording(truth, 2.5), kRate));
  }
}

/// What a microphone hears before the strike at 0.55 s: `add` gives a value per second of the recording.
void expect_same_modes_after(const char* what, const std::function<double(double)>& add) {
  const std::vector<scene::ModeConfig> truth = {
      {240.0, 1.2, 0.0}, {630.3, 0.46, -4.0}, {1170.9, 0.25, -9.0}, {1820.4, 0.16, -12.0}};
  const std::vector<float> strike = recording(truth, 2.0);
  std::vector<float> sound(strike.size() + 24000);
  for (std::size_t i = 0; i < sound.size(); ++i)
    sound[i] = static_cast<float>(add(static_cast<double>(i) / kRate)) + (i < 24000 ? 0.0F : strike[i - 24000]);
  SCOPED_TRACE(what);
  expect_modes(truth, fit_modes(sound, kRate));
}

TEST(Fit, WhatIsHeardBeforeTheStrikeDoesNotChangeItsModes) {
  // A tenth of the strike's peak (0.5) and more, each.
  expect_same_modes_after("a click", [](double t) { return t >= 0.1 && t < 0.101 ? 0.12 : 0.0; });
  expect_same_modes_after("a constant", [](double) { return 0.08; });
  expect_same_modes_after("a soft strike of the same pillar", [](double t) {
    return t < 0.05
               ? 0.0
               : 0.1 * std::exp(-6.907755 * (t - 0.05) / 1.2) * std::sin(2.0 * std::numbers::pi * 240.0 * (t - 0.05));
  });
}

TEST(Fit, SilenceNoiseAndClicksHaveNoModes) {
  EXPECT_TRUE(fit_modes({}, kRate).empty());
  EXPECT_TRUE(fit_modes(std::vector<float>(48000, 0.0F), kRate).empty());
  std::vector<float> click(48000, 0.0F);
  click[1000] = 0.9F;
  EXPECT_TRUE(fit_modes(click, kRate).empty());
  EXPECT_TRUE(fit_modes(recording({}, 1.0, 0.1), kRate).empty());
}

TEST(Fit, NoiseHasNoModesSteadyOrDyingAway) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    for (const double falls_in_s : {1e9, 0.35, 0.14}) {  // by 60 dB
      std::mt19937 random(seed);
      std::normal_distribution<double> normal;
      std::vector<float> noise(48000);
      for (std::size_t i = 0; i < noise.size(); ++i)
        noise[i] = static_cast<float>(0.2 * normal(random) *
                                      std::exp(-6.907755 * static_cast<double>(i) / (kRate * falls_in_s)));
      EXPECT_TRUE(fit_modes(noise, kRate).empty()) << "seed " << seed << ", " << falls_in_s << " s";
    }
  }
}

TEST(Fit, FindsAModeThatIsAloneAndHigh) {
  for (const double frequency_hz : {8000.0, 9500.0, 14000.0}) {
    const std::vector<scene::ModeConfig> truth = {{frequency_hz, 0.3, 0.0}};
    expect_modes(truth, fit_modes(recording(truth, 1.0), kRate));
  }
}

TEST(Fit, ModesThatBeatAreLeftOutByName) {
  std::vector<double> left_out;
  const std::vector<scene::ModeConfig> truth = {{240.0, 1.2, 0.0}, {440.0, 1.2, -3.0}, {443.0, 1.2, -4.0}};
  const auto found = fit_modes(recording(truth, 2.0), kRate, 16, &left_out);
  expect_modes({truth.front()}, found);
  ASSERT_GE(left_out.size(), 1U);
  for (const double frequency : left_out) EXPECT_NEAR(frequency, 441.5, 6.0);
  left_out.clear();
  static_cast<void>(fit_modes(recording({truth[0], truth[1]}, 2.0), kRate, 16, &left_out));
  EXPECT_TRUE(left_out.empty()) << left_out.front();
}

TEST(Fit, WhatWasFittedSoundsLikeWhatWasRecorded) {
  const std::vector<scene::ModeConfig> truth = {{311.0, 0.8, 0.0}, {702.0, 0.5, -6.0}};
  scene::ModalConfig modal;
  modal.modes = fit_modes(recording(truth, 2.0), kRate);
  auto region = audio_scene::note("x", {0, 0, 1, 1}, 1.0, 1.0);
  region.sound = modal;
  Synth synth(audio_scene::bank({region}));
  synth.strike({0, 1.0, 0.5}, 0);
  const auto sound = listening::channel(audio_scene::render(synth, 1.0), 0);
  for (const scene::ModeConfig& mode : truth) {
    const double heard =
        listening::strongest_frequency(sound, 0.95 * mode.frequency_hz, 1.05 * mode.frequency_hz, kRate, 2400, 24000);
    EXPECT_LT(std::abs(1200.0 * std::log2(heard / mode.frequency_hz)), 3.0);
    EXPECT_NEAR(listening::t60_s(sound, mode.frequency_hz, kRate, 0.05, 0.4) / mode.decay_s, 1.0, 0.06);
  }
}

TEST(Fit, TheRecordingsAtHandLoadAndPlayAsClips) {
  const char* folder = std::getenv("SPARSHA_SCANS_DIR");
  if (folder == nullptr) GTEST_SKIP() << "SPARSHA_SCANS_DIR names no folder of recordings";
  int found = 0;
  for (const std::string name : {"metal-impact.wav", "stone-impact.wav", "perc_bell.flac"}) {
    const std::filesystem::path file = std::filesystem::path(folder) / "audio" / name;
    if (!std::filesystem::exists(file)) continue;
    ++found;
    Synth synth(audio_scene::bank({audio_scene::clip("x", {0, 0, 1, 1}, file)}));
    EXPECT_TRUE(synth.contact(audio_scene::touch(0.0, 0.5, 0.5, 2.0), 0));
    const auto sound = listening::channel(audio_scene::render(synth, 0.3), 0);
    EXPECT_GT(listening::peak(sound), 0.01) << name;
    const Clip clip = load_clip(file, 48000);
    std::vector<float> mono;
    for (std::size_t i = 0; i < clip.frames(); ++i)
      mono.push_back(0.5F * (clip.samples[2 * i] + clip.samples[2 * i + 1]));
    const std::size_t modes = fit_modes(mono, kRate).size();
    std::printf("%s: %.2f s, %zu modes\n", name.c_str(), static_cast<double>(clip.frames()) / 48000.0, modes);
    if (name == "perc_bell.flac") {
      EXPECT_GE(modes, 4U);
    }
  }
  if (found == 0) GTEST_SKIP() << "no recording in " << folder << "/audio";
}

}  // namespace
