// Struck pillars: pitch, decay, partials, loudness, brightness.
#include <gtest/gtest.h>

#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;
using audio_scene::bank;
using audio_scene::note;

constexpr double kRate = 48000.0;

listening::Samples strike(const std::vector<scene::AudioRegionConfig>& regions, double force_n, double seconds,
                          double position = 0.5) {
  Synth synth(bank(regions));
  synth.strike({0, force_n, position}, 0);
  return listening::channel(audio_scene::render(synth, seconds), 0);
}

std::size_t at(double seconds) { return static_cast<std::size_t>(seconds * kRate); }

TEST(Pillar, FundamentalIsWithinHalfAHertzOfTheConfiguredFrequency) {
  for (const double frequency : {61.7, 240.0, 440.0, 1234.5, 4000.0}) {
    const auto sound = strike({note("sa", {0, 0, 1, 1}, frequency, 1.2)}, 1.0, 2.5);
    const double heard =
        listening::strongest_frequency(sound, 0.8 * frequency, 1.2 * frequency, kRate, at(0.05), at(2.0));
    EXPECT_NEAR(heard, frequency, 0.5) << frequency;
  }
}

TEST(Pillar, FundamentalIsTheStrongestLineOfTheWholeNote) {
  for (const double force : {0.1, 1.0, 8.0})
    for (const double position : {0.0, 0.2, 0.5, 0.9}) {
      const auto sound = strike({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}, force, 1.5, position);
      EXPECT_NEAR(listening::strongest_frequency(sound, 50.0, 4000.0, kRate, 0, at(1.5)), 240.0, 0.5);
    }
}

TEST(Pillar, FallsBySixtyDecibelsInDecayTimeWithinFivePercent) {
  for (const double decay : {0.3, 1.2, 4.0}) {
    const auto sound = strike({note("sa", {0, 0, 1, 1}, 240.0, decay)}, 1.0, decay);
    EXPECT_NEAR(listening::t60_s(sound, 240.0, kRate, 0.1 * decay, 0.8 * decay) / decay, 1.0, 0.05);
  }
}

TEST(Pillar, PartialsAreThoseOfAStoutBarHeldAtBothEndsAndDieSoonerTheHigherTheyAre) {
  // Oracle: Timoshenko's beam by its published low-frequency expansion, evaluated here from tabulated roots.
  const double roots[] = {4.730040745, 7.853204624, 10.995607838, 14.137165491};
  const auto factor = [](double k) {
    const double slender = k * 0.025;
    return k * k / std::sqrt(1.0 + slender * slender * (1.0 + 2.4 / 0.9));
  };
  const auto modes = pillar_modes({240.0, 1.2, {}}, 20000.0);
  ASSERT_GE(modes.count, 4U);
  const auto sound = strike({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}, 8.0, 1.5, 0.27);
  for (std::size_t n = 0; n < 4; ++n) {
    const double ratio = factor(roots[n]) / factor(roots[0]);
    EXPECT_NEAR(modes.partials[n].frequency_hz, 240.0 * ratio, 1e-6 * 240.0 * ratio);
    EXPECT_NEAR(modes.partials[n].t60_s, 1.2 / ratio, 1e-6);
    EXPECT_NEAR(listening::strongest_frequency(sound, 230.0 * ratio, 250.0 * ratio, kRate, at(0.01), at(0.4)),
                240.0 * ratio, 1.0);
  }
}

TEST(Pillar, OddModesAreSilentWhenStruckInTheMiddle) {
  const auto modes = pillar_modes({240.0, 1.2, {}}, 20000.0);
  const auto sound = strike({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}, 8.0, 0.5, 0.5);
  const double second = listening::amplitude_at(sound, modes.partials[1].frequency_hz, kRate, at(0.02), at(0.4));
  const double first = listening::amplitude_at(sound, 240.0, kRate, at(0.02), at(0.4));
  EXPECT_LT(listening::decibel(second / first), -60.0);
}

TEST(Pillar, LoudnessGrowsWithForceAndStaysUnderTheCeiling) {
  double last = 0.0;
  for (double force = 0.02; force <= 20.0; force *= 1.2) {
    const auto sound = strike({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}, force, 0.5, 0.3);
    const double level = listening::rms(sound, 0, at(0.4));
    EXPECT_GT(level, last) << force;
    EXPECT_LE(listening::peak(sound), kCeiling + 1e-7);
    last = level;
  }
}

TEST(Pillar, AOneNewtonStrikePeaksBetweenMinusThirteenAndMinusFiveDecibels) {
  for (const double frequency : {80.0, 240.0, 1000.0, 3000.0}) {
    const double peak =
        listening::decibel(listening::peak(strike({note("sa", {0, 0, 1, 1}, frequency, 1.2)}, 1.0, 0.2)));
    EXPECT_GT(peak, -13.0) << frequency;
    EXPECT_LT(peak, -5.0) << frequency;
  }
}

TEST(Pillar, AHarderStrikeIsBrighter) {
  const auto modes = pillar_modes({240.0, 1.2, {}}, 20000.0);
  double last = -1e9;
  for (const double force : {0.1, 0.3, 1.0, 3.0, 10.0}) {
    const auto sound = strike({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}, force, 0.3, 0.3);
    const double third = listening::amplitude_at(sound, modes.partials[2].frequency_hz, kRate, at(0.01), at(0.15));
    const double first = listening::amplitude_at(sound, 240.0, kRate, at(0.01), at(0.15));
    EXPECT_GT(third / first, last);
    last = third / first;
  }
}

TEST(Pillar, SoundBeginsExactlyAtItsSampleWithoutAStep) {
  for (const std::uint64_t frame : {0U, 1U, 63U, 64U, 1000U, 47999U}) {
    Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}));
    synth.strike({0, 8.0, 0.5}, frame);
    const auto sound = listening::channel(audio_scene::render(synth, 1.2), 0);
    EXPECT_EQ(listening::onset(sound), frame + Synth::latency_frames());
    EXPECT_LT(std::abs(sound[frame + Synth::latency_frames()]), 0.01 * listening::peak(sound));
  }
}

TEST(Pillar, StrikingAgainAddsToWhatStillRings) {
  const auto regions = std::vector{note("sa", {0, 0, 1, 1}, 240.0, 1.2)};
  const auto play = [&](bool first, bool second) {
    Synth synth(bank(regions));
    if (first) synth.strike({0, 1.0, 0.5}, 100);
    if (second) synth.strike({0, 0.5, 0.3}, 5000);
    return listening::channel(audio_scene::render(synth, 0.5), 0);
  };
  const auto both = play(true, true), one = play(true, false), two = play(false, true);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_NEAR(both[i], one[i] + two[i], 1e-6);
}

TEST(Pillar, DiesToExactSilence) {
  Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 0.2)}));
  synth.strike({0, 8.0, 0.5}, 0);
  audio_scene::render(synth, 1.0);
  EXPECT_FALSE(synth.sounding());
  for (const float value : audio_scene::render(synth, 0.1)) ASSERT_EQ(value, 0.0F);
}

TEST(Pillar, IsTunedWithin1CentAndDecaysWithin2PercentAtEverySampleRateAndEquallyLoud) {
  std::vector<double> levels;
  for (const int rate : {44100, 48000, 96000}) {
    for (const double frequency : {61.7, 240.0, 1234.5, 4000.0}) {
      Synth synth(make_sound_bank(*audio_scene::scene({note("sa", {0, 0, 1, 1}, frequency, 1.2)}), rate));
      synth.strike({0, 0.3, 0.5}, 0);
      const auto sound = listening::channel(audio_scene::render(synth, 1.5), 0);
      const auto at_rate = [&](double seconds) { return static_cast<std::size_t>(seconds * rate); };
      const double heard =
          listening::strongest_frequency(sound, 0.9 * frequency, 1.1 * frequency, rate, at_rate(0.05), at_rate(1.4));
      EXPECT_LT(std::abs(1200.0 * std::log2(heard / frequency)), 1.0) << frequency << " at " << rate;
      EXPECT_NEAR(listening::t60_s(sound, frequency, rate, 0.1, 0.9) / 1.2, 1.0, 0.02) << frequency << " at " << rate;
      if (frequency == 240.0) levels.push_back(listening::decibel(listening::rms(sound, at_rate(0.01), at_rate(0.5))));
    }
  }
  EXPECT_NEAR(levels[0], levels[1], 0.1);
  EXPECT_NEAR(levels[2], levels[1], 0.1);
}

TEST(Loudness, TheMeterOfTheseTestsReadsASineOfFullScaleAsTheStandardSays) {
  // BS.1770: 0 dB full scale at 997 Hz in one channel reads -3.01 LUFS.
  std::vector<float> tone;
  for (int i = 0; i < 96000; ++i)
    tone.insert(tone.end(), {static_cast<float>(std::sin(2.0 * std::numbers::pi * 997.0 * i / 48000.0)), 0.0F});
  EXPECT_NEAR(listening::integrated_lufs(tone), -3.01, 0.02);
}

}  // namespace
