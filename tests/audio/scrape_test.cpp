// The friction sound: follows speed, force and roughness; silent at rest; no zipper noise.
#include "audio/scrape.h"

#include <gtest/gtest.h>

#include "audio/synth.h"
#include "audio_scene.h"
#include "listening.h"

namespace {

using namespace sparsha::audio;

constexpr double kRate = 48000.0;

listening::Samples play(Scrape& scrape, double seconds) {
  listening::Samples result(static_cast<std::size_t>(seconds * kRate));
  for (double& value : result) value = scrape.next();
  return result;
}

double level(const ScrapeInput& input) {
  Scrape scrape(0.5, kRate);
  scrape.set(input);
  play(scrape, 0.2);
  const auto sound = play(scrape, 2.0);
  return listening::rms(sound, 0, sound.size());
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

TEST(Scrape, IsExactlySilentAtRestInTheAirAndForNotANumber) {
  Scrape scrape(0.5, kRate);
  for (const ScrapeInput& input :
       {ScrapeInput{}, ScrapeInput{0.0, 5.0, 0.5}, ScrapeInput{0.1, 0.0, 0.5}, ScrapeInput{std::nan(""), 1.0, 0.5}}) {
    scrape.set(input);
    for (const double value : play(scrape, 0.1)) ASSERT_EQ(value, 0.0);
  }
}

TEST(Scrape, LevelGrowsAsTheSquareRootOfSpeedForceAndFriction) {
  // 2 s of noise in a band of at least 250 Hz: 1000 independent values, level known to 0.3 dB; 1 dB is three of these.
  const double base = level({0.05, 1.0, 0.4});
  EXPECT_NEAR(listening::decibel(level({0.1, 1.0, 0.4}) / base), 3.01, 1.0);
  EXPECT_NEAR(listening::decibel(level({0.05, 2.0, 0.4}) / base), 3.01, 1.0);
  EXPECT_NEAR(listening::decibel(level({0.05, 1.0, 0.85}) / base), 3.01, 1.0);
  double last = 0.0;
  for (const double speed : {0.01, 0.02, 0.04, 0.08, 0.16}) {
    const double now = level({speed, 1.0, 0.4});
    EXPECT_GT(now, last);
    last = now;
  }
}

TEST(Scrape, PitchRisesWithSpeed) {
  double last = 0.0;
  for (const double speed : {0.02, 0.06, 0.18, 0.4}) {
    Scrape scrape(0.5, kRate);
    scrape.set({speed, 1.0, 0.4});
    play(scrape, 0.2);
    const double centre = centroid_hz(play(scrape, 1.0));
    EXPECT_GT(centre, 1.15 * last);
    last = centre;
  }
}

TEST(Scrape, StopsWithinATenthOfASecondToExactZeros) {
  Scrape scrape(0.5, kRate);
  scrape.set({0.2, 3.0, 0.5});
  play(scrape, 0.5);
  scrape.set({});
  play(scrape, 0.1);
  EXPECT_FALSE(scrape.sounding());
  for (const double value : play(scrape, 0.1)) ASSERT_EQ(value, 0.0);
}

TEST(Scrape, ControlStepsAreNotHeardAsZipperNoise) {
  // Speed in steps of 1 ms against the same movement in steps of one sample: the difference is far below the sound.
  const auto stroke = [](std::size_t every) {
    Scrape scrape(0.5, kRate);
    listening::Samples sound(48000);
    for (std::size_t i = 0; i < sound.size(); ++i) {
      const double t = static_cast<double>(i - i % every) / kRate;
      if (i % every == 0) scrape.set({0.1 + 0.08 * std::sin(2.0 * std::numbers::pi * 3.0 * t), 1.0, 0.4});
      sound[i] = scrape.next();
    }
    return sound;
  };
  const auto coarse = stroke(48), fine = stroke(1);
  listening::Samples difference(coarse.size());
  for (std::size_t i = 0; i < coarse.size(); ++i) difference[i] = coarse[i] - fine[i];
  const double ratio = listening::rms(difference, 4800, 48000) / listening::rms(fine, 4800, 48000);
  EXPECT_LT(listening::decibel(ratio), -35.0);
}

TEST(Scrape, TakesNormalForceAndSlipFromTheState) {
  sparsha::haptics::State state;
  state.contact = 1;
  state.slip_speed_m_per_s = 0.1;
  state.normal = {0.0, 0.6, 0.8};
  state.force_n = {1.0, 0.6, 0.8};
  state.friction_coefficient = 0.3;
  const ScrapeInput input = scrape_input(state);
  EXPECT_DOUBLE_EQ(input.normal_force_n, 1.0);
  EXPECT_DOUBLE_EQ(input.speed_m_per_s, 0.1);
  EXPECT_DOUBLE_EQ(input.friction_coefficient, 0.3);
  state.flags = sparsha::haptics::kFlagFault;
  EXPECT_EQ(scrape_input(state).speed_m_per_s, 0.0);
  state.flags = 0;
  state.contact = 0;
  EXPECT_EQ(scrape_input(state).speed_m_per_s, 0.0);
}

}  // namespace
