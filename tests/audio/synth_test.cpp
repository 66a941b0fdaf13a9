// The block renderer: silence, regions, determinism, stealing, ceiling, no allocation.
#include "audio/synth.h"

#include <gtest/gtest.h>

#include <random>

#include "audio_scene.h"
#include "listening.h"
#include "tests/support/allocations.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;
using audio_scene::bank;
using audio_scene::note;
using audio_scene::touch;

TEST(Synth, SilenceIsExactZeros) {
  Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}, 0.5));
  for (const float value : audio_scene::render(synth, 1.0)) ASSERT_EQ(value, 0.0F);
  EXPECT_FALSE(synth.sounding());
}

TEST(Synth, FirstRegionThatHoldsThePointSoundsBordersIncluded) {
  const auto regions =
      std::vector{note("low", {0.0, 0.0, 0.5, 1.0}, 200.0, 1.0), note("high", {0.5, 0.0, 1.0, 1.0}, 500.0, 1.0),
                  note("under", {0.0, 0.0, 1.0, 1.0}, 900.0, 1.0)};
  const auto heard = [&](double x, double y) {
    Synth synth(bank(regions));
    if (!synth.contact(touch(0.0, x, y, 1.0), 0)) return 0.0;
    const auto sound = listening::channel(audio_scene::render(synth, 0.5), 0);
    return std::round(listening::strongest_frequency(sound, 100.0, 1200.0, 48000.0, 500, 24000));
  };
  EXPECT_EQ(heard(0.25, 0.5), 200.0);
  EXPECT_EQ(heard(0.5, 0.5), 200.0);
  EXPECT_EQ(heard(0.75, 0.5), 500.0);
  EXPECT_EQ(heard(1.0, 1.0), 500.0);
  EXPECT_EQ(heard(1.01, 0.5), 0.0);
  EXPECT_EQ(heard(std::nan(""), 0.5), 0.0);
}

TEST(Synth, SoundsOnceAContactAndOnlyOnTouch) {
  Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}));
  EXPECT_TRUE(synth.contact(touch(1.0, 0.5, 0.5, 1.0), 48000));
  auto slip = touch(1.1, 0.5, 0.5, 1.0);
  slip.kind = haptics::ContactEvent::Kind::slip;
  EXPECT_FALSE(synth.contact(slip, 52800));
  EXPECT_FALSE(synth.contact(audio_scene::lift(1.2), 57600));
  EXPECT_FALSE(synth.contact(touch(1.205, 0.5, 0.5, 1.0), 57840)) << "a flutter of 5 ms is the same contact";
  EXPECT_TRUE(synth.contact(touch(1.3, 0.5, 0.5, 1.0), 62400));
  EXPECT_FALSE(synth.contact(touch(1.4, 0.5, 0.5, 0.0), 67200));
  EXPECT_FALSE(synth.contact(touch(1.4, 0.5, 0.5, std::nan("")), 67200));
}

/// A busy second: 300 strikes of 20 pillars and strokes between, seeded.
std::vector<float> busy(std::size_t block) {
  std::vector<pipeline::AudioRegionConfig> regions;
  for (int i = 0; i < 20; ++i)
    regions.push_back(note("n", {i / 20.0, 0, (i + 1) / 20.0, 1}, 150.0 + 37.0 * i, 0.1 + 0.1 * i));
  Synth synth(bank(regions, 0.5));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const auto frame = static_cast<std::uint64_t>(48000.0 * unit(random));
    const auto region = static_cast<std::size_t>(20.0 * unit(random)) % 20;
    synth.strike({region, 3.0 * unit(random), unit(random)}, frame);
    if (i % 3 == 0) synth.scrape({0.2 * unit(random), 3.0 * unit(random), unit(random)}, frame);
  }
  return audio_scene::render(synth, 1.5, block);
}

TEST(Synth, SameEventsGiveTheSameBytesHoweverTimeIsCutIntoBlocks) {
  const auto reference = busy(256);
  for (const std::size_t block : {1U, 17U, 64U, 100U, 4096U, 72000U}) EXPECT_EQ(busy(block), reference) << block;
}

TEST(Synth, TruePeakStaysUnderMinusOneDecibelWhateverIsStruck) {
  std::vector<pipeline::AudioRegionConfig> regions;
  for (int i = 0; i < 12; ++i) regions.push_back(note("n", {0, 0, 1, 1}, 200.0 * std::pow(1.37, i), 2.0));
  Synth synth(bank(regions, 1.0));
  for (std::size_t i = 0; i < 12; ++i)
    for (std::uint64_t k = 0; k < 4; ++k) synth.strike({i, 20.0, 0.3}, 100 + 900 * i + 9000 * k);
  synth.scrape({0.5, 8.0, 0.9}, 0);
  const auto sound = listening::channel(audio_scene::render(synth, 1.5), 0);
  EXPECT_GT(listening::peak(sound), 0.7) << "the limiter should have had something to do";
  EXPECT_LE(listening::peak(sound), kCeiling + 1e-7);
  EXPECT_LE(listening::decibel(listening::true_peak(sound)), -1.0);
}

TEST(Synth, StealingPillarsMakesNoClick) {
  // 100 very low pillars (whose own waves bend little) in 100 ms, 48 may ring: 52 are cut. A strike bends the wave by
  // its pulse, a cut bends it by its fade (half a cosine of 240 frames); one without fade would step by up to the
  // pillar's amplitude.
  std::vector<pipeline::AudioRegionConfig> regions;
  for (int i = 0; i < 100; ++i) regions.push_back(note("n", {0, 0, 1, 1}, 20.0 + 0.1 * i, 3.0));
  Synth crowded(bank(regions)), alone(bank(regions));
  for (std::size_t i = 0; i < 100; ++i) crowded.strike({i, 0.02, 0.5}, 48 * i);
  alone.strike({0, 0.02, 0.5}, 0);
  const auto full = listening::channel(audio_scene::render(crowded, 0.4), 0);
  const auto one = listening::channel(audio_scene::render(alone, 0.4), 0);
  EXPECT_EQ(crowded.dropped(), 0U);
  EXPECT_GT(listening::peak(one), 0.005);
  // At most 7 pulses and 6 fades overlap, each no sharper than the sharpest bend of a lone strike.
  EXPECT_LT(listening::sharpest_corner(full, 0, full.size()), 13.0 * listening::sharpest_corner(one, 0, one.size()));
}

TEST(Synth, RenderingAllocatesNothing) {
  Synth synth(bank({note("sa", {0, 0, 0.5, 1}, 240.0, 1.2), note("re", {0.5, 0, 1, 1}, 270.0, 1.2)}, 0.5));
  std::vector<float> block(512);
  const std::size_t before = allocations::count();
  for (int i = 0; i < 200; ++i) {
    synth.contact(touch(0.1 * i, i % 2 == 0 ? 0.2 : 0.7, 0.5, 1.0), synth.frame());
    synth.contact(audio_scene::lift(0.1 * i + 0.05), synth.frame());
    synth.scrape({0.1, 1.0, 0.4}, synth.frame() + 20);
    synth.render(block);
  }
  EXPECT_EQ(allocations::count(), before);
  EXPECT_GT(listening::peak(listening::channel(block, 0)), 0.0);
}

TEST(Synth, MoreEventsThanHandsCanMakeAreCountedNotLost) {
  Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}));
  for (std::uint64_t i = 0; i < 600; ++i) synth.strike({0, 1.0, 0.5}, 1000 + i);
  EXPECT_EQ(synth.dropped(), 600U - 512U);
}

TEST(Synth, TheSameStrikeAtAHundredPhasesOfTheTickIsEquallyLoudWithinOneDecibel) {
  // A hand of 0.15 kg meets a wall of 800 N/m at 0.2 m/s at every phase of the 1 ms tick. The servo says when and how
  // hard.
  const double peak_force = 0.2 * std::sqrt(800.0 * 0.15);
  double least = 1e9, most = -1e9;
  for (int phase = 0; phase < 100; ++phase) {
    const double contact_s = 0.1 + phase * 1e-5;
    const double tick_s = std::ceil(contact_s * 1000.0 - 1e-9) / 1000.0;
    Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}));
    synth.contact(touch(tick_s, 0.5, 0.5, peak_force), static_cast<std::uint64_t>(std::llround(tick_s * 48000.0)));
    const auto sound = listening::channel(audio_scene::render(synth, 0.5), 0);
    const double level = listening::decibel(listening::rms(sound, 4800, 19200));
    least = std::min(least, level);
    most = std::max(most, level);
  }
  EXPECT_LT(most - least, 1.0);
}

}  // namespace
