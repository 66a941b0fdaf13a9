// What the sound card gets: words over loud sounds, and notes at any rate that a card may have.
#include "audio/live/voice.h"

#include <gtest/gtest.h>

#include "scene/material/sound_limits.h"
#include "tests/audio/audio_scene.h"

namespace {

using namespace sparsha;
using namespace sparsha::audio;

std::shared_ptr<const Clip> words_of(float value, std::size_t frames) {
  auto words = std::make_shared<Clip>();
  words->samples.assign(2 * frames, value);
  return words;
}

/// Largest magnitude of a pillar that is struck as hard as can be every 50 ms while words of 0.6 begin in it.
double loudest_with_words(float words) {
  haptics::ContactQueue contacts(64);
  haptics::Seqlock<haptics::State> state;
  std::atomic<std::uint64_t> strikes{0};
  LiveVoice voice(audio_scene::bank({audio_scene::note("sa", {0, 0, 1, 1}, 240.0, 2.0)}), contacts, state, nullptr,
                  strikes);
  double most = 0.0;
  std::vector<float> block(256);
  const auto spoken = words_of(words, 9600);
  for (int k = 0; k < 600; ++k) {
    if (k % 19 == 0) {
      contacts.push(audio_scene::touch(0.05 * k / 19.0, 0.5, 0.5, 20.0));
      contacts.push(audio_scene::lift(0.05 * k / 19.0 + 0.001));
    }
    if (k == 200) voice.speak(spoken);
    voice.render(block);
    for (const float value : block) most = std::max(most, static_cast<double>(std::abs(value)));
  }
  return most;
}

TEST(LiveVoice, WordsOverASoundAtTheCeilingNeverReachFullScale) {
  EXPECT_GT(loudest_with_words(0.0F), 0.8);  // the sound alone is at the ceiling
  EXPECT_LT(loudest_with_words(0.6F), 1.0);
  EXPECT_LT(loudest_with_words(-0.6F), 1.0);
}

TEST(LiveVoice, AllWordsAreHeardAlthoughTheyWaitForTheOtherSounds) {
  haptics::ContactQueue contacts(64);
  haptics::Seqlock<haptics::State> state;
  std::atomic<std::uint64_t> strikes{0};
  LiveVoice voice(audio_scene::bank({}), contacts, state, nullptr, strikes);
  const auto words = words_of(0.5F, 4800);
  voice.speak(words);
  std::vector<float> block(256);
  std::size_t frames = 0;
  for (int k = 0; k < 150; ++k) {
    voice.render(block);
    for (std::size_t i = 0; i < block.size(); i += 2) frames += block[i] == 0.5F ? 1U : 0U;
  }
  EXPECT_EQ(frames, 4800U);
}

TEST(LiveVoice, NotesAboveWhatTheRateCanCarryStayBounded) {
  for (const int rate : {8000, 11025, 16000}) {
    scene::AudioRegionConfig bronze = audio_scene::note("bronze", {0, 0, 0.5, 1}, 240.0, 1.0);
    scene::MaterialSoundConfig material;
    material.frequency_hz = scene::kMostFrequency_hz;
    bronze.sound = material;
    const auto scene =
        audio_scene::scene({bronze, audio_scene::note("high", {0.5, 0, 1, 1}, scene::kMostFrequency_hz, 1.0)}, 1.0);
    const auto bank = make_sound_bank(*scene, rate);
    Synth synth(bank);
    const auto profile = audio_scene::rough_profile();
    synth.profile(profile, 0);
    double most = 0.0;
    for (int tick = 1; tick <= 1000; ++tick) {
      const double time_s = 1e-3 * tick;
      if (tick == 100) synth.contact(audio_scene::touch(time_s, 0.2, 0.5, 1.0), synth.frame());
      if (tick == 600) synth.contact(audio_scene::touch(time_s, 0.7, 0.5, 1.0), synth.frame());
      synth.state(audio_scene::stroking(time_s, 0.2 + 0.2 * time_s, 0.5), synth.frame());
      std::vector<float> block(2 * static_cast<std::size_t>(rate / 1000));
      synth.render(block);
      for (const float value : block) {
        ASSERT_TRUE(std::isfinite(value)) << rate;
        most = std::max(most, static_cast<double>(std::abs(value)));
      }
    }
    for (const SoundRegion& region : bank->regions)
      if (const auto* modes = std::get_if<Modes>(&region.sound)) {
        for (std::size_t n = 0; n < modes->count; ++n) EXPECT_LE(modes->partials[n].frequency_hz, 0.45 * rate);
      }
    EXPECT_GT(most, 0.0) << rate;
    EXPECT_LE(most, 0.8414) << rate;  // the limiter's ceiling, -1.5 dB
  }
}

}  // namespace
