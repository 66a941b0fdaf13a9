// The block renderer: silence, regions, determinism, stealing, ceiling, no allocation.
#include "audio/synth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "base/png/png.h"
#include "base/yaml/yaml.h"
#include "haptics/state/state.h"
#include "scene/config/config.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"
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

/// A busy second: 300 strikes of 20 pillars and strokes across them, seeded.
std::vector<float> busy(std::size_t block) {
  std::vector<scene::AudioRegionConfig> regions;
  for (int i = 0; i < 20; ++i)
    regions.push_back(note("n", {i / 20.0, 0, (i + 1) / 20.0, 1}, 150.0 + 37.0 * i, 0.1 + 0.1 * i));
  Synth synth(bank(regions, 0.5));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const auto frame = static_cast<std::uint64_t>(48000.0 * unit(random));
    const auto region = static_cast<std::size_t>(20.0 * unit(random)) % 20;
    synth.strike({region, 3.0 * unit(random), unit(random)}, frame);
  }
  const auto profile = audio_scene::rough_profile();
  synth.profile(profile, 0);
  for (double t = 0.0; t < 1.0; t += 1e-3)
    synth.state(audio_scene::stroking(t, 0.5 + 0.3 * std::sin(5.0 * t), 0.4, std::max(0.0, std::sin(40.0 * t))),
                static_cast<std::uint64_t>(48000.0 * t));
  return audio_scene::render(synth, 1.5, block);
}

TEST(Synth, SameEventsGiveTheSameBytesHoweverTimeIsCutIntoBlocks) {
  const auto reference = busy(256);
  for (const std::size_t block : {1U, 17U, 64U, 100U, 4096U, 72000U}) EXPECT_EQ(busy(block), reference) << block;
}

TEST(Synth, LoudnessIsProportionalToTheForceOfTheStrike) {
  const auto amplitude = [](double force_n) {
    Synth synth(bank({note("sa", {0, 0, 1, 1}, 240.0, 1.2)}));
    synth.strike({0, force_n, 0.3}, 0);
    const auto sound = listening::channel(audio_scene::render(synth, 0.6), 0);
    return listening::amplitude_at(sound, 240.0, 48000.0, 4800, 24000);
  };
  const double one = amplitude(1.0);
  for (const double force_n : {0.05, 0.25, 0.5, 1.5})
    EXPECT_NEAR(listening::decibel(amplitude(force_n) / (force_n * one)), 0.0, 0.2) << force_n << " N";
}

TEST(Synth, TruePeakStaysUnderMinusOneDecibelWhateverIsStruck) {
  std::vector<scene::AudioRegionConfig> regions;
  for (int i = 0; i < 12; ++i) regions.push_back(note("n", {0, 0, 1, 1}, 200.0 * std::pow(1.37, i), 2.0));
  Synth synth(bank(regions, 1.0));
  for (std::size_t i = 0; i < 12; ++i)
    for (std::uint64_t k = 0; k < 4; ++k) synth.strike({i, 20.0, 0.3}, 100 + 900 * i + 9000 * k);
  const auto profile = audio_scene::rough_profile();
  synth.profile(profile, 0);
  for (double time_s = 0.0; time_s < 1.0; time_s += 1e-3)
    synth.state(audio_scene::stroking(time_s, 0.1 + 0.5 * time_s, 0.4, 8.0),
                static_cast<std::uint64_t>(48000.0 * time_s));
  const auto sound = listening::channel(audio_scene::render(synth, 1.5), 0);
  EXPECT_GT(listening::peak(sound), 0.7) << "the limiter should have had something to do";
  EXPECT_LE(listening::peak(sound), kCeiling + 1e-7);
  EXPECT_LE(listening::decibel(listening::true_peak(sound)), -1.0);
}

TEST(Synth, StealingPillarsMakesNoClick) {
  // 100 very low pillars (whose own waves bend little) in 100 ms, 48 may ring: 52 are cut. A strike bends the wave by
  // its pulse, a cut bends it by its fade (half a cosine of 240 frames); one without fade would step by up to the
  // pillar's amplitude.
  std::vector<scene::AudioRegionConfig> regions;
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
  const auto notes = bank({note("sa", {0, 0, 0.5, 1}, 240.0, 1.2), note("re", {0.5, 0, 1, 1}, 270.0, 1.2)}, 0.5);
  const auto with_cues = std::make_shared<SoundBank>(*notes);
  with_cues->cues = scene::CuesConfig{};
  Synth synth(with_cues);
  std::vector<float> block(512);
  const auto profile = audio_scene::rough_profile();
  const std::size_t before = allocations::count();
  for (int i = 0; i < 200; ++i) {
    synth.contact(touch(0.1 * i, i % 2 == 0 ? 0.2 : 0.7, 0.5, 1.0), synth.frame());
    synth.contact(audio_scene::lift(0.1 * i + 0.05), synth.frame());
    synth.profile(profile, synth.frame());
    haptics::State hand = audio_scene::stroking(0.1 * i + 0.01, 0.3 + 0.001 * i, 0.5, i % 60 < 30 ? 1.0 : 0.0);
    hand.cues.fill(static_cast<std::uint64_t>(i / 7));
    hand.away_m = 0.05;
    hand.device_m = {0.001 * i, 0.0, 0.0};
    synth.state(hand, synth.frame() + 20);
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

TEST(Synth, AHandThatSlidesOntoAnotherRegionPlaysItOnceAndGoesOnToTheNext) {
  // Three notes of 3 cm, a gap of 1 cm between them; at 10 cm/s, then the same way back.
  const auto regions =
      std::vector{note("sa", {0.00, 0, 0.03, 1}, 240.0, 0.5), note("re", {0.04, 0, 0.07, 1}, 270.0, 0.5),
                  note("ga", {0.08, 0, 0.11, 1}, 300.0, 0.5)};
  Synth synth(bank(regions));
  EXPECT_TRUE(synth.contact(touch(0.0, 0.01, 0.5, 1.0), 0));
  std::vector<double> played;
  for (double t = 0.001; t < 1.6; t += 0.002) {
    auto state = audio_scene::stroking(t, t < 0.8 ? 0.01 + 0.1 * t : 0.17 - 0.1 * t, 0.5);
    state.slip_speed_m_per_s = 0.1;
    if (synth.state(state, static_cast<std::uint64_t>(48000.0 * t))) played.push_back(t);
  }
  ASSERT_EQ(played.size(), 4U);
  const std::array<double, 4> entered = {0.3, 0.7, 1.0, 1.4};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_GE(played[k], entered[k]) << "never before the hand is there";
    EXPECT_LE(played[k], entered[k] + 0.008);
  }
}

TEST(Synth, AHandThatRestsOrTremblesOnABorderPlaysNothing) {
  Synth synth(bank({note("sa", {0, 0, 0.5, 1}, 240.0, 0.5), note("re", {0.5, 0, 1, 1}, 270.0, 0.5)}));
  synth.contact(touch(0.0, 0.499, 0.5, 1.0), 0);
  for (int i = 1; i < 2000; ++i) {
    auto state = audio_scene::stroking(i * 1e-3, i / 7 % 2 == 0 ? 0.4999 : 0.5001, 0.5);
    state.slip_speed_m_per_s = 0.006;
    EXPECT_FALSE(synth.state(state, static_cast<std::uint64_t>(48 * i)));
  }
}

TEST(Synth, OfAThousandStrikesNoneIsLostAndNoneIsDoubled) {
  // Strikes of 20 ms at the pace of a fast hand, each seen as an event and by the states of the contact.
  std::vector<scene::AudioRegionConfig> regions;
  for (int i = 0; i < 8; ++i) regions.push_back(note("n", {i / 8.0, 0, (i + 1) / 8.0, 1}, 200.0 + 30.0 * i, 0.4));
  Synth synth(bank(regions));
  int heard = 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.07 * i, x = (i % 8 + 0.5) / 8.0;
    heard += synth.contact(touch(t, x, 0.5, 0.5), static_cast<std::uint64_t>(48000.0 * t)) ? 1 : 0;
    for (int k = 1; k < 20; k += 2)
      heard +=
          synth.state(audio_scene::stroking(t + 1e-3 * k, x, 0.5), static_cast<std::uint64_t>(48000.0 * t)) ? 1 : 0;
    heard += synth.contact(audio_scene::lift(t + 0.02), static_cast<std::uint64_t>(48000.0 * t)) ? 1 : 0;
    audio_scene::render(synth, 0.07);
  }
  EXPECT_EQ(heard, 1000);
  EXPECT_EQ(synth.dropped(), 0U);
}

TEST(Synth, NoDenormalNumberLeaves) {
  // Beside a mode that rings for a minute, one that is over in 5 ms would fall to 1e-320.
  scene::AudioRegionConfig region = note("sa", {0, 0, 1, 1}, 240.0, 1.0);
  scene::ModalConfig modal;
  modal.modes = {{60.0, 60.0, 0.0}, {3000.0, 0.005, 0.0}};
  region.sound = modal;
  Synth synth(bank({region}));
  synth.strike({0, 1.0, 0.5}, 0);
  for (const float value : audio_scene::render(synth, 20.0)) ASSERT_NE(std::fpclassify(value), FP_SUBNORMAL);
}

TEST(Stroking, IsSilentInTheAirInAFaultWithoutForceAndForPlacesThatAreNotNumbers) {
  const auto peak = [](const auto& spoil) {
    Synth synth(bank({}, 0.5));
    const auto profile = audio_scene::rough_profile();
    synth.profile(profile, 0);
    double most = 0.0;
    for (int tick = 1; tick <= 500; ++tick) {
      haptics::State state = audio_scene::stroking(1e-3 * tick, 0.2 + 1e-4 * tick, 0.5);
      spoil(state);
      synth.state(state, static_cast<std::uint64_t>(48 * tick));
      for (const float value : audio_scene::render(synth, 1e-3)) {
        if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
        most = std::max(most, static_cast<double>(std::abs(value)));
      }
    }
    return most;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(peak([](haptics::State&) {}), 1e-3);
  EXPECT_EQ(peak([](haptics::State& state) { state.flags |= haptics::kFlagFault; }), 0.0);
  EXPECT_EQ(peak([](haptics::State& state) {
              state.flags |= haptics::kFlagStale;
              state.given_share = 0.0;
            }),
            0.0);
  EXPECT_GT(peak([](haptics::State& state) { state.flags |= haptics::kFlagStale; }), 1e-3)
      << "the force goes on for some milliseconds without news";
  EXPECT_EQ(peak([](haptics::State& state) { state.contact = 0; }), 0.0);
  EXPECT_EQ(peak([](haptics::State& state) { state.given_share = 0.0; }), 0.0) << "stone that gives no force";
  EXPECT_LT(peak([](haptics::State& state) { state.given_share = 0.1; }), peak([](haptics::State&) {}));
  EXPECT_EQ(peak([&](haptics::State& state) { state.proxy_m[0] = nan; }), 0.0);
  EXPECT_EQ(peak([&](haptics::State& state) { state.force_n[2] = nan; }), 0.0);
  EXPECT_EQ(peak([&](haptics::State& state) { state.scale = nan; }), 0.0);
}

TEST(Regions, APolygonOfMoreThanAThousandCornersIsAnErrorWithItsPlace) {
  const auto parse = [](int corners) {
    std::string text =
        "scans: [{file: a.ply}]\naudio:\n  regions:\n    - name: sa\n      modal: {}\n      polygon_m: [";
    for (int i = 0; i < corners; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / corners;
      text += (i > 0 ? ", [" : "[") + std::to_string(std::cos(turn)) + ", " + std::to_string(std::sin(turn)) + "]";
    }
    return scene::parse_config(yaml::parse_text(text + "]\n", "own.yaml"), {});
  };
  EXPECT_EQ(parse(1000).audio->regions[0].polygon_m.size(), 1000U);
  try {
    (void)parse(1001);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(error.place().line, 6);
    EXPECT_NE(error.wrong().find("1001 corners"), std::string::npos) << error.wrong();
  }
}

TEST(Materials, EachSoundsWithItsModesAndDecays) {
  for (std::size_t m = 0; m < scene::kMaterials.size(); ++m) {
    scene::AudioRegionConfig region = note("x", {0, 0, 1, 1}, 1.0, 1.0);
    scene::MaterialSoundConfig material;
    material.material = static_cast<scene::Material>(m);
    region.sound = material;
    Synth synth(bank({region}));
    synth.strike({0, 1.0, 0.5}, 0);
    const auto sound = listening::channel(audio_scene::render(synth, 2.0), 0);
    const scene::MaterialSound& table = scene::kMaterials[m].sound;
    const double t60 = 2.2 / (table.damping * table.frequency_hz);
    const auto end = static_cast<std::size_t>(48000.0 * std::min(1.9, 0.05 + 0.7 * t60));
    const double heard =
        listening::strongest_frequency(sound, 0.9 * table.frequency_hz, 1.1 * table.frequency_hz, 48000.0, 1200, end);
    EXPECT_NEAR(heard / table.frequency_hz, 1.0, 0.002) << scene::kMaterials[m].name;
    // Two windows of 50 ms at least; the next mode leaks into them, the more the shorter the piece is.
    const double from = 0.1 * t60, to = std::max(from + 0.08, std::min(1.9, 0.6 * t60));
    EXPECT_NEAR(listening::t60_s(sound, table.frequency_hz, 48000.0, from, to) / t60, 1.0, 0.005 + 0.005 / (to - from))
        << scene::kMaterials[m].name;
  }
}

TEST(Materials, FrequencyDampingAndBrightnessOfARegionReplaceTheTables) {
  scene::MaterialSoundConfig material;
  material.material = scene::Material::bronze;
  material.frequency_hz = 400.0;
  material.damping = 0.005;
  material.brightness = 0.0;
  scene::AudioRegionConfig region = note("x", {0, 0, 1, 1}, 1.0, 1.0);
  region.sound = material;
  Synth synth(bank({region}));
  synth.strike({0, 1.0, 0.5}, 0);
  const auto sound = listening::channel(audio_scene::render(synth, 1.5), 0);
  EXPECT_NEAR(listening::strongest_frequency(sound, 100.0, 5000.0, 48000.0, 1200, 40000), 400.0, 0.3);
  EXPECT_NEAR(listening::t60_s(sound, 400.0, 48000.0, 0.05, 0.8), 2.2 / (0.005 * 400.0), 0.02);
  const double second = listening::amplitude_at(sound, 1.73 * 400.0, 48000.0, 1200, 20000);
  EXPECT_LT(listening::decibel(second / listening::amplitude_at(sound, 400.0, 48000.0, 1200, 20000)), -60.0);
}

TEST(Materials, OfTheWholeSceneAnswerATapEverywhereButRegionsAndPartsComeFirst) {
  scene::AudioConfig audio;
  audio.regions = {note("sa", {0, 0, 0.2, 1}, 240.0, 1.0)};
  audio.material = scene::MaterialSoundConfig{};
  const auto scene = sparsha::test::scene_of([](double, double) { return 0.0; }, {2, 2, 1.0},
                                             [&](scene::SceneDescription& made) {
                                               made.config.audio = audio;
                                               scene::PartConfig part;
                                               part.name = "door";
                                               part.box_m = {0.1, 0, 0.5, 1};
                                               part.touch.material = scene::Material::wood;
                                               made.config.parts = {part};
                                             });
  const auto sounds = make_sound_bank(*scene, 48000);
  EXPECT_EQ(sounds->region_at({0.15, 0.5, 0.0}), 0U);
  ASSERT_TRUE(sounds->region_at({0.3, 0.5, 0.0}));
  EXPECT_EQ(sounds->regions[*sounds->region_at({0.3, 0.5, 0.0})].name, "door");
  ASSERT_TRUE(sounds->region_at({7.0, -3.0, 0.0}));
  EXPECT_TRUE(sounds->regions[*sounds->region_at({7.0, -3.0, 0.0})].everywhere);
  Synth synth(sounds);
  EXPECT_TRUE(synth.contact(touch(0.0, 0.8, 0.8, 1.0), 0));
}

TEST(Regions, PolygonsAndLabelImagesHoldTheirPlaces) {
  const audio_scene::Folder folder;
  // 3 x 2 pixels: the top row is 7 0 9.
  const std::vector<std::uint8_t> pixels = {0, 7, 0, 0, 0, 9, 0, 0, 0, 7, 0, 0};
  PngFormat format;
  format.width = 3;
  format.height = 2;
  format.pixel = PngFormat::Pixel::grey16;
  write_png(folder / "labels.png", format, pixels);
  auto polygon = note("re", {0, 0, 0, 0}, 270.0, 1.0);
  polygon.box_m.reset();
  polygon.polygon_m = {{2.0, 2.0}, {4.0, 2.0}, {2.0, 4.0}};
  auto label = note("sa", {0, 0, 0, 0}, 240.0, 1.0);
  label.box_m.reset();
  label.label = 7;
  scene::AudioConfig audio;
  audio.regions = {polygon, label};
  audio.labels = scene::LabelImageConfig{folder / "labels.png", std::array<double, 4>{0, 0, 3, 2}};
  const auto scene = sparsha::test::scene_of([](double, double) { return 0.0; }, {2, 2, 1.0},
                                             [&](scene::SceneDescription& made) { made.config.audio = audio; });
  const auto sounds = make_sound_bank(*scene, 48000);
  EXPECT_TRUE(sounds->warnings.empty());
  EXPECT_EQ(sounds->region_at({2.5, 2.5, 0.0}), 0U);
  EXPECT_EQ(sounds->region_at({3.5, 3.5, 0.0}), std::nullopt);
  EXPECT_EQ(sounds->region_at({0.5, 1.5, 0.0}), 1U);
  EXPECT_EQ(sounds->region_at({1.5, 0.5, 0.0}), 1U);
  EXPECT_EQ(sounds->region_at({0.5, 0.5, 0.0}), std::nullopt);
  EXPECT_EQ(sounds->region_at({2.5, 1.5, 0.0}), std::nullopt);
  EXPECT_EQ(sounds->region_at({std::nan(""), 0.0, 0.0}), std::nullopt);
}

}  // namespace
