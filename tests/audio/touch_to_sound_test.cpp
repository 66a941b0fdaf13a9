// From a moving hand through the servo's own tick to the sound: loudness, time of the onset, determinism.
#include <gtest/gtest.h>

#include "haptics/servo/haptic_renderer.h"
#include "tests/audio/audio_scene.h"
#include "tests/audio/listening.h"
#include "tests/support/scenes.h"
#include "tests/support/servo_parts.h"
#include "tests/support/soft_stone.h"

namespace {

using namespace sparsha;

struct Heard {
  double level_db = 0.0;
  double contact_s = 0.0;  ///< when the hand really met the surface
  std::size_t onset = 0;   ///< frame
};

/// A hand comes down on a plane at `speed`, `phase` of a tick late, read by an encoder of 0.058 mm.
Heard strike(double speed_m_per_s, double phase) {
  const auto scene = sparsha::test::flat_scene();
  haptics::DeviceInfo info;
  info.name = "scripted";
  haptics::HapticRenderer tick(info, {}, haptics::window_on(scene));
  audio::Synth synth(audio_scene::bank({audio_scene::note("sa", {-1, -1, 1, 1}, 240.0, 1.2)}));
  constexpr double kEncoder_m = 58e-6;
  const double start_m = 0.2 * speed_m_per_s + 0.002;
  Heard heard;
  heard.contact_s = start_m / speed_m_per_s + phase * 1e-3;
  for (int i = 0; i < 400; ++i) {
    const double time_s = i * 1e-3;
    // Stops 3 mm deep, as the wall makes it.
    const double z = std::max(-0.003, -speed_m_per_s * (time_s - heard.contact_s));
    tick.update(haptics::sample_at({0.0, 0.0, kEncoder_m * std::round(z / kEncoder_m)}, time_s), 1e-3);
    if (tick.event())
      synth.contact(*tick.event(), static_cast<std::uint64_t>(std::llround(tick.event()->time_s * 48000.0)));
  }
  const auto sound = listening::channel(audio_scene::render(synth, 1.0), 0);
  heard.onset = listening::onset(sound) - audio::Synth::latency_frames();
  heard.level_db = listening::decibel(listening::rms(sound, heard.onset + 2400, heard.onset + 14400));
  return heard;
}

TEST(TouchToSound, TheSameStrikeAtAHundredPhasesOfTheTickIsEquallyLoudWithinOneDecibel) {
  for (const double speed : {0.05, 0.2, 0.5}) {
    double least = 1e9, most = -1e9;
    for (int phase = 0; phase < 100; ++phase) {
      const double level = strike(speed, 0.01 * phase).level_db;
      least = std::min(least, level);
      most = std::max(most, level);
    }
    EXPECT_LT(most - least, 1.0) << speed << " m/s";
    std::printf("%.2f m/s: %.2f to %.2f dB\n", speed, least, most);
  }
}

TEST(TouchToSound, SoundIsNeverFirstAndAtMostATickAndTheEncoderLate) {
  for (const double speed : {0.05, 0.2, 0.5})
    for (int phase = 0; phase < 20; ++phase) {
      const Heard heard = strike(speed, 0.05 * phase);
      const double late_s = static_cast<double>(heard.onset) / 48000.0 - heard.contact_s;
      // The encoder rounds: it may report the surface up to half a step early or late.
      const double encoder_s = 0.5 * 58e-6 / speed;
      EXPECT_GE(late_s, -encoder_s - 1e-9);
      EXPECT_LE(late_s, 1e-3 + encoder_s + 1.0 / 48000.0);
    }
}

TEST(TouchToSound, AFasterHandIsLouder) {
  double last = -1e9;
  for (const double speed : {0.02, 0.05, 0.1, 0.2, 0.4}) {
    const double level = strike(speed, 0.3).level_db;
    EXPECT_GT(level, last + 1.0);
    last = level;
  }
}

TEST(TouchToSound, StoneThatGivesNoForceIsNeitherStruckNorStroked) {
  sparsha::test::SoftStone stone(haptics::window_on(sparsha::test::flat_scene()));
  const auto loudest = [&](bool soft) {
    audio::Synth synth(audio_scene::bank({audio_scene::note("sa", {-1, -1, 0.055, 1}, 240.0, 1.2),
                                          audio_scene::note("re", {0.055, -1, 1, 1}, 270.0, 1.2)},
                                         0.5));
    synth.profile(audio_scene::rough_profile(), 0);
    double most = 0.0;
    for (int k = 0; k < 600; ++k) {
      const bool lifted = k % 50 >= 40;
      const double depth_m = soft ? (lifted ? -0.0005 : 0.02) : (lifted ? -0.002 : 0.002);
      const haptics::State& state = stone.go({3e-5 * k, 0.0, -depth_m});
      const auto frame = static_cast<std::uint64_t>(48 * k);
      if (stone.renderer().event()) synth.contact(*stone.renderer().event(), frame);
      synth.state(state, frame);
      for (const float value : audio_scene::render(synth, 1e-3)) most = std::max(most, std::abs(double{value}));
    }
    return most;
  };
  EXPECT_EQ(loudest(true), 0.0);
  for (int k = 0; k < 100; ++k) stone.go({0.0, 0.0, 0.02});
  EXPECT_GT(loudest(false), 0.01) << "after the hand has been in the air";
}

}  // namespace
