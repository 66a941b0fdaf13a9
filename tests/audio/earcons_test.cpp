// What tells a hand without sight where it has come to: which sound, when, and none that is turned off.
#include "audio/earcons.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>

#include "audio/synth.h"
#include "haptics/servo/haptic_renderer.h"
#include "haptics/window/window.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"
#include "tests/support/servo_parts.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;
using listening::Samples;
using scene::Cue;

constexpr double kRate = 48000.0;

std::shared_ptr<const SoundBank> bank_with(const std::optional<scene::CuesConfig>& cues, int rate = 48000) {
  auto bank = std::make_shared<SoundBank>(*make_sound_bank(*audio_scene::scene({}), rate));
  bank->cues = cues;
  return bank;
}

/// A hand in the air over the stone.
haptics::State hand(double time_s) {
  haptics::State state = audio_scene::stroking(time_s, 0.5, 0.5, 0.0);
  state.flags |= haptics::kFlagCues;
  return state;
}

/// What is heard of a hand that `live` makes of each millisecond.
Samples hear(double seconds, const std::optional<scene::CuesConfig>& cues,
             const std::function<void(haptics::State&)>& live, int rate = 48000, std::size_t block = 256) {
  Synth synth(bank_with(cues, rate));
  std::vector<float> sound;
  haptics::State state = hand(0.0);
  for (int k = 0; k < static_cast<int>(std::lround(1000.0 * seconds)); ++k) {
    const std::array<std::uint64_t, scene::kCues> counts = state.cues;
    state = hand(1e-3 * k);
    state.cues = counts;
    live(state);
    synth.state(state, static_cast<std::uint64_t>(std::llround(state.time_s * rate)));
    if (k % 100 < 99) continue;
    const auto more = audio_scene::render(synth, 0.1, block);
    sound.insert(sound.end(), more.begin(), more.end());
  }
  return listening::channel(sound, 0);
}

/// A hand to which `cue` happens once, at `at_s`.
std::function<void(haptics::State&)> once(Cue cue, double at_s = 0.1, double scale_after = 2.0) {
  return [=](haptics::State& state) {
    const bool then = state.time_s >= at_s - 1e-9;
    state.cues[static_cast<std::size_t>(cue)] = then ? 1 : 0;
    if (cue == Cue::level) state.scale = then ? scale_after : 1.0;
  };
}

constexpr std::array<Cue, scene::kCues> kAll{Cue::level, Cue::edge, Cue::unmeasured, Cue::part_entered, Cue::part_left};

double pitch(const Samples& sound, double from_s, double to_s) {
  return listening::strongest_frequency(sound, 100.0, 3000.0, kRate, static_cast<std::size_t>(from_s * kRate),
                                        static_cast<std::size_t>(to_s * kRate));
}

std::size_t last_sound(const Samples& sound) {
  std::size_t end = sound.size();
  while (end > 0 && sound[end - 1] == 0.0) --end;
  return end;
}

TEST(Earcons, EachBeginsAtItsTickIsShortAndEndsInSilence) {
  for (const Cue cue : kAll) {
    const Samples sound = hear(0.6, scene::CuesConfig{}, once(cue));
    const std::size_t begin = listening::onset(sound) - Synth::latency_frames();
    EXPECT_GE(begin, 4800U) << static_cast<int>(cue);
    EXPECT_LE(begin, 4802U) << "the first sample of an envelope is zero";
    EXPECT_LE(last_sound(sound), 4800U + 14400U) << "0.3 s";
    const double loudest = listening::rms(sound, 4800, 4800 + 7200);
    EXPECT_GT(listening::decibel(loudest), -35.0) << static_cast<int>(cue);
    EXPECT_LT(listening::decibel(loudest), -20.0) << static_cast<int>(cue);
  }
}

TEST(Earcons, AreToldApartByPitchAndHowItGoes) {
  const auto heard = [](Cue cue, double scale = 2.0) { return hear(0.6, scene::CuesConfig{}, once(cue, 0.1, scale)); };
  const double d = static_cast<double>(Synth::latency_frames()) / kRate;
  // The first half and the second: a glide, two notes, or the same note.
  const auto way = [&](const Samples& sound, double length_s) {
    return pitch(sound, 0.1 + d + 0.55 * length_s, 0.1 + d + length_s) /
           pitch(sound, 0.1 + d, 0.1 + d + 0.4 * length_s);
  };
  EXPECT_GT(way(heard(Cue::level), 0.16), 1.2) << "closer: up";
  EXPECT_LT(way(heard(Cue::level, 0.5), 0.16), 1.0 / 1.2) << "farther: down";
  EXPECT_NEAR(way(heard(Cue::part_entered), 0.18), 4.0 / 3.0, 0.02) << "a fourth up";
  EXPECT_NEAR(way(heard(Cue::part_left), 0.18), 3.0 / 4.0, 0.02) << "a fourth down";
  EXPECT_LT(pitch(heard(Cue::edge), 0.1, 0.25), 260.0) << "low";
  // Two knocks with silence between them; a flutter of thirty a second.
  const Samples edge = heard(Cue::edge);
  const auto level = [&](const Samples& sound, double from_s, double to_s) {
    return listening::rms(sound, static_cast<std::size_t>((0.1 + d + from_s) * kRate),
                          static_cast<std::size_t>((0.1 + d + to_s) * kRate));
  };
  EXPECT_LT(level(edge, 0.06, 0.085), 1e-3 * level(edge, 0.0, 0.05));
  EXPECT_GT(level(edge, 0.09, 0.14), 0.5 * level(edge, 0.0, 0.05));
  const Samples unmeasured = heard(Cue::unmeasured);
  for (int k = 1; k < 6; ++k) {
    const double trough_s = k / 30.0;
    EXPECT_LT(level(unmeasured, trough_s - 0.002, trough_s + 0.002),
              0.2 * level(unmeasured, trough_s - 0.5 / 30.0 - 0.004, trough_s - 0.5 / 30.0 + 0.004));
  }
  EXPECT_GT(pitch(unmeasured, 0.1, 0.34), 290.0);
  EXPECT_LT(pitch(unmeasured, 0.1, 0.34), 370.0);
}

TEST(Earcons, AreTurnedOffOneByOneToExactSilence) {
  for (const Cue off : kAll) {
    scene::CuesConfig config;
    config.sound[static_cast<std::size_t>(off)] = false;
    for (const Cue cue : kAll) {
      const Samples sound = hear(0.5, config, once(cue));
      EXPECT_EQ(last_sound(sound) == 0, cue == off) << static_cast<int>(off) << " " << static_cast<int>(cue);
    }
  }
  for (const Cue cue : kAll) EXPECT_EQ(last_sound(hear(0.5, std::nullopt, once(cue))), 0U) << "without the block";
}

TEST(Earcons, WhatTheFirstStateCountsIsPastAndMakesNoSound) {
  const Samples sound = hear(0.5, scene::CuesConfig{}, [](haptics::State& state) { state.cues = {3, 1, 4, 1, 5}; });
  EXPECT_EQ(last_sound(sound), 0U);
}

TEST(Earcons, HaveNoClicksAndTheSameLevelAndPitchAtEverySampleRate) {
  for (const Cue cue : kAll) {
    const Samples reference = hear(0.6, scene::CuesConfig{}, once(cue));
    const auto line = listening::spectrum(reference, 0, 24000);
    const double bin = kRate / (2.0 * static_cast<double>(line.size()));
    double below = 0.0, above = 0.0;
    for (std::size_t k = 0; k < line.size(); ++k) {
      const double frequency_hz = static_cast<double>(k) * bin;
      if (frequency_hz < 5000.0) below += line[k] * line[k];
      if (frequency_hz > 8000.0) above += line[k] * line[k];
    }
    EXPECT_LT(10.0 * std::log10(above / below), -70.0) << static_cast<int>(cue);
    for (const int rate : {44100, 96000}) {
      const Samples other = hear(0.6, scene::CuesConfig{}, once(cue), rate);
      const auto at = [&](double seconds) { return static_cast<std::size_t>(seconds * rate); };
      EXPECT_NEAR(listening::decibel(listening::rms(other, at(0.1), at(0.4)) / listening::rms(reference, 4800, 19200)),
                  0.0, 0.1)
          << rate;
      if (cue == Cue::level) continue;  // a glide has no strongest line
      EXPECT_NEAR(listening::strongest_frequency(other, 100.0, 3000.0, rate, at(0.1), at(0.4)) /
                      listening::strongest_frequency(reference, 100.0, 3000.0, kRate, 4800, 19200),
                  1.0, 0.002)
          << rate;
    }
  }
}

TEST(Earcons, SameStatesGiveTheSameSamplesHoweverTimeIsCutIntoBlocks) {
  const auto live = [](haptics::State& state) {
    const auto k = static_cast<std::uint64_t>(state.time_s * 4.0);
    state.cues = {k, (k + 1) / 2, k / 2, k / 3, (k + 2) / 3};
    state.away_m = state.time_s > 1.0 ? 0.06 : 0.0;
    state.device_m = {0.01 * std::sin(state.time_s), 0.01 * std::cos(state.time_s), 0.0};
  };
  const Samples whole = hear(4.0, scene::CuesConfig{}, live, 48000, 4800);
  EXPECT_EQ(hear(4.0, scene::CuesConfig{}, live, 48000, 37), whole);
  EXPECT_GT(last_sound(whole), 180000U);
}

/// Beeps of a hand that stays `away_m` from the stone and trembles: when each begins, and how high they are.
struct Beeps {
  std::vector<double> begin_s;
  double pitch_hz = 0.0;
};
Beeps beeps(double away_m, double seconds = 6.0) {
  const Samples sound = hear(seconds, scene::CuesConfig{}, [&](haptics::State& state) {
    // From afar first: a hand that is near is not lost.
    state.away_m = state.time_s < 2.0 ? std::max(away_m, 0.05) : away_m;
    state.device_m = {0.01 * std::sin(6.0 * state.time_s), 0.0, 0.0};
  });
  Beeps found;
  std::size_t quiet = 4800;
  for (std::size_t i = 0; i < sound.size(); ++i) {
    if (std::abs(sound[i]) < 1e-6) {
      ++quiet;
      continue;
    }
    if (quiet > 480) found.begin_s.push_back(static_cast<double>(i) / kRate);
    quiet = 0;
  }
  if (found.begin_s.size() > 2) {
    const double last_s = found.begin_s[found.begin_s.size() - 2];
    found.pitch_hz = pitch(sound, last_s, last_s + 0.07);
  }
  return found;
}

TEST(Lost, AHandFarFromTheStoneHearsATheSoonerAndHigherToneTheNearerItComes) {
  double last_pause_s = 1e9, last_pitch_hz = 0.0;
  for (const double away_m : {0.3, 0.08, 0.05, 0.03, 0.01}) {
    const Beeps heard = beeps(away_m);
    ASSERT_GT(heard.begin_s.size(), 4U) << away_m;
    EXPECT_NEAR(heard.begin_s.front(), Earcons::kLostFor_s, 0.005) << away_m;
    const double pause_s = heard.begin_s.back() - heard.begin_s[heard.begin_s.size() - 2];
    EXPECT_LT(pause_s, 0.95 * last_pause_s) << away_m;
    EXPECT_GT(heard.pitch_hz, 1.03 * last_pitch_hz) << away_m;
    last_pause_s = pause_s;
    last_pitch_hz = heard.pitch_hz;
  }
}

TEST(Lost, TheToneEndsAtTheStoneAndIsNeverHeardWhereAHandIsNotLost) {
  const auto heard_after = [](double from_s, const std::function<void(haptics::State&)>& live,
                              scene::CuesConfig config = {}) {
    const Samples sound = hear(6.0, config, [&](haptics::State& state) {
      state.away_m = 0.06;
      state.device_m = {0.01 * std::sin(6.0 * state.time_s), 0.0, 0.0};
      live(state);
    });
    return last_sound(sound) > static_cast<std::size_t>((from_s + 0.15) * kRate);
  };
  EXPECT_TRUE(heard_after(5.0, [](haptics::State&) {}));
  EXPECT_FALSE(heard_after(3.0, [](haptics::State& s) { s.away_m = s.time_s < 3.0 ? 0.06 : 0.004; })) << "found";
  EXPECT_FALSE(heard_after(3.0, [](haptics::State& s) {
    if (s.time_s >= 3.0) s.contact = 1;
  })) << "touches";
  EXPECT_FALSE(heard_after(0.0, [](haptics::State& s) { s.away_m = 0.02; })) << "a hand above the stone";
  EXPECT_FALSE(heard_after(0.0, [](haptics::State& s) { s.away_m = std::fmod(s.time_s, 1.4) < 1.2 ? 0.06 : 0.0; }))
      << "never long enough";
  EXPECT_FALSE(heard_after(0.0, [](haptics::State& s) { s.flags |= haptics::kFlagStale; }));
  EXPECT_FALSE(heard_after(0.0, [](haptics::State& s) { s.flags |= haptics::kFlagFault; }));
  EXPECT_FALSE(heard_after(0.0, [](haptics::State& s) { s.flags &= ~std::uint64_t{haptics::kFlagArmed}; }));
  EXPECT_FALSE(heard_after(0.0, [](haptics::State& s) { s.away_m = std::nan(""); }));
  scene::CuesConfig off;
  off.lost = false;
  EXPECT_FALSE(heard_after(
      0.0, [](haptics::State&) {}, off))
      << "turned off";
}

TEST(Lost, AHandThatIsLaidDownIsLeftInPeaceAndHearsTheToneAgainWhenItIsTakenUp) {
  const Samples sound = hear(14.0, scene::CuesConfig{}, [&](haptics::State& state) {
    state.away_m = 0.06;
    if (state.time_s > 12.0) state.device_m = {0.03, 0.0, 0.0};
  });
  const auto heard = [&](double from_s, double to_s) {
    return listening::rms(sound, static_cast<std::size_t>(from_s * kRate), static_cast<std::size_t>(to_s * kRate)) >
           0.0;
  };
  EXPECT_TRUE(heard(2.0, 7.9));
  EXPECT_FALSE(heard(8.2, 12.0));
  EXPECT_TRUE(heard(12.05, 13.5));
}

TEST(Earcons, AHandThatTravelsOverAStoneHearsWhatItComesTo) {
  // A level stone of 0.1 m, a part from 40 to 60 mm, from 80 mm on nothing measured.
  const auto scene = sparsha::test::scene_of([](double x, double) { return x < 0.0801 ? 0.0 : std::nan(""); }, 201, 0.1,
                                             201, Eigen::Vector3d::Zero(),
                                             [](scene::SceneDescription& d) {
                                               d.config.haptics.tip_radius_m = 0.0;
                                               d.config.cues = scene::CuesConfig{};
                                               d.config.parts.push_back({"middle", "", {0.04, -1.0, 0.06, 1.0}});
                                             });
  haptics::HapticRenderer renderer(
      haptics::DeviceInfo{}, {},
      haptics::load_window(*scene, haptics::plan_window(scene->description(), 0, {0.05, 0.05}, 0.1), 1));
  Synth synth(make_sound_bank(*scene, 48000));
  std::vector<float> interleaved;
  int k = 0;
  const auto go = [&](double x_m, double z_m) {
    const double time_s = 1e-3 * k++;
    renderer.update(haptics::sample_at({x_m - 0.05, 0.0, z_m}, time_s), 1e-3);
    synth.state(renderer.state(), static_cast<std::uint64_t>(std::llround(time_s * kRate)));
    const auto more = audio_scene::render(synth, 1e-3, 48);
    interleaved.insert(interleaved.end(), more.begin(), more.end());
  };
  for (int i = 0; i < 400; ++i) go(0.02, std::max(-0.001, 0.01 - 5e-5 * i));
  for (int i = 0; i < 2600; ++i) go(0.02 + 5e-5 * i, -0.001);
  for (int i = 0; i < 4000; ++i) go(0.15 + 0.02 * std::sin(0.003 * i), std::min(0.03, -0.001 + 1e-4 * i));
  const Samples sound = listening::channel(interleaved, 0);
  const auto begins = [&](double x_m) {  // at the tick at which the hand is there, or within a node of 0.5 mm
    const auto at = static_cast<std::size_t>((0.4 + (x_m - 0.02) / 0.05) * kRate);
    return listening::rms(sound, at - 2400, at - 960) == 0.0 && listening::rms(sound, at + 960, at + 2880) > 1e-3;
  };
  EXPECT_TRUE(begins(0.04)) << "entered";
  EXPECT_TRUE(begins(0.06)) << "left";
  EXPECT_TRUE(begins(0.08)) << "not measured";
  EXPECT_TRUE(begins(0.10)) << "the edge";
  EXPECT_GT(listening::rms(sound, static_cast<std::size_t>(5.5 * kRate), static_cast<std::size_t>(6.9 * kRate)), 1e-3)
      << "lost";
}

}  // namespace
